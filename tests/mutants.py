"""All mutants of the core in one build; the environment variable MUTANT says which of them lives.

cargo-mutants lists them. A build of each takes a minute and a half, because all formulas are
inlined into the loops of the kernels, and there are two thousand: so every expression that has
mutants becomes a choice among them, made anew each time that it is evaluated.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import tree_sitter
import tree_sitter_rust

ROOT = Path(__file__).parent.parent
ALIVE = "crate::mutant::alive()"
COMPARISONS = ("==", "!=", "<", ">", "<=", ">=")

# The variable is read before `main`, in test programs as in the extension.
CHOICE = """use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

static ALIVE: AtomicU32 = AtomicU32::new(0);

#[inline(always)]
pub fn alive() -> u32 {
    ALIVE.load(Relaxed)
}

#[used]
#[unsafe(link_section = ".init_array")]
static CHOOSE: extern "C" fn() = choose;

extern "C" fn choose() {
    let chosen = std::env::var("MUTANT").ok().and_then(|text| text.parse().ok());
    ALIVE.store(chosen.unwrap_or(0), Relaxed);
}
"""

# As fast as a build with choices gets: nothing vectorises, and one instruction set is enough.
PROFILE = """
[profile.mutants]
inherits = "test"
opt-level = 1
debug = false
incremental = false
"""


class Mutant(NamedTuple):
    """One line of cargo-mutants' list, its place in bytes."""

    number: int
    genre: str
    start: int
    end: int
    replacement: str


class File:
    """One source file and its mutants."""

    def __init__(self, path: Path, listed: Iterable[tuple[int, dict[str, Any]]]) -> None:
        self.text = path.read_bytes()
        lines = self.text.decode().splitlines(keepends=True)
        starts = [0]
        for line in lines:
            starts.append(starts[-1] + len(line.encode()))

        def place(at: dict[str, int]) -> int:
            line = lines[at["line"] - 1]
            return starts[at["line"] - 1] + len(line[: at["column"] - 1].encode())

        language = tree_sitter.Language(tree_sitter_rust.language())
        self.root = tree_sitter.Parser(language).parse(self.text).root_node
        self.functions = [node for node in descendants(self.root) if node.type == "function_item"]
        self.at: dict[tuple[int, str], list[Mutant]] = defaultdict(list)
        for number, entry in listed:
            start, end = (place(entry["span"][side]) for side in ("start", "end"))
            if entry["genre"] == "FnValue":
                # The span is what stands between the braces.
                around = [f for f in self.functions if f.start_byte <= start and end <= f.end_byte]
                body = min(around, key=lambda f: f.end_byte - f.start_byte)
                start = body.child_by_field_name("body").start_byte
            mutant = Mutant(number, entry["genre"], start, end, entry["replacement"])
            self.at[start, mutant.genre].append(mutant)

    def source(self, start: int, end: int) -> str:
        return self.text[start:end].decode()

    def children(self, node: tree_sitter.Node, after: int | None = None) -> str:
        """The node's source with choices in its children, from a place on."""
        at = node.start_byte if after is None else after
        parts = []
        for child in node.children:
            if child.start_byte >= at:
                parts += [self.source(at, child.start_byte), self.render(child)]
                at = child.end_byte
        return "".join([*parts, self.source(at, node.end_byte)])

    def render(self, node: tree_sitter.Node) -> str:
        """The node's source with choices for all mutants in it."""
        if node.type in ("binary_expression", "compound_assignment_expr"):
            operator = node.child_by_field_name("operator")
            found = self.at.get((operator.start_byte, "BinaryOperator"))
            if found and not is_constant(node):
                left = self.render(node.child_by_field_name("left"))
                right = self.render(node.child_by_field_name("right"))
                return binary(operator.text.decode(), left, right, found)
        if node.type == "unary_expression":
            found = self.at.get((node.start_byte, "UnaryOperator"))
            if found and not is_constant(node):
                operand = "".join(self.render(child) for child in node.children[1:])
                operator = node.children[0].text.decode()
                return f"({{ let x = {operand}; {choice(found, lambda _: 'x', operator + 'x')} }})"
        if node.type == "match_arm":
            return self.arm(node)
        found = self.at.get((node.start_byte, "FnValue"))
        if node.type == "block" and found and not is_constant(node):
            early = "".join(
                f"\n/*{m.number}*/ if {ALIVE} == {m.number} {{ return {m.replacement}; }}\n"
                for m in found
            )
            return "{" + early + self.children(node)[1:]
        return self.children(node)

    def arm(self, node: tree_sitter.Node) -> str:
        pattern = node.child_by_field_name("pattern")
        condition = pattern.child_by_field_name("condition")
        deleted = self.at.get((node.start_byte, "MatchArm"), [])
        guards = self.at.get((condition.start_byte, "MatchArmGuard"), []) if condition else []
        if not deleted and not guards:
            return self.children(node)
        guard, end = "true", pattern.end_byte
        if condition:
            guard = choice(guards, lambda text: text, f"({self.render(condition)})")
            end = next(child.start_byte for child in pattern.children if child.type == "if")
        for mutant in deleted:
            guard = f"{ALIVE} != /*{mutant.number}*/ {mutant.number} && ({guard})"
        head = self.source(node.start_byte, end)
        return f"{head} if ({guard}) {self.children(node, pattern.end_byte)}"


def descendants(node: tree_sitter.Node) -> Iterable[tree_sitter.Node]:
    yield node
    for child in node.children:
        yield from descendants(child)


def is_constant(node: tree_sitter.Node) -> bool:
    """Whether the compiler evaluates it: a choice has to wait until the program runs."""
    while node:
        if node.type in ("const_item", "static_item", "array_type"):
            return True
        if node.type == "function_item":
            words = [child.text for child in node.children if child.type == "function_modifiers"]
            return any(b"const" in text for text in words)
        node = node.parent
    return False


def choice(mutants: Iterable[Mutant], mutated: Callable[[str], str], other: str) -> str:
    # A line each, so that the line of an error names its mutant.
    arms = "".join(f"\n/*{m.number}*/ {m.number} => {mutated(m.replacement)},\n" for m in mutants)
    return f"match {ALIVE} {{ {arms} _ => {other} }}"


def binary(operator: str, left: str, right: str, found: list[Mutant]) -> str:
    """A choice of operators; the operands are written once, or nesting would multiply them."""

    def chosen(form: str) -> str:
        return choice(found, lambda other: form.format(other), form.format(operator))

    if operator in ("&&", "||"):
        right = right.replace("{", "{{").replace("}", "}}")
        return f"({{ let l = {left}; {chosen(f'(l {{}} {right})')} }})"
    if operator in COMPARISONS:
        return f"({{ let (l, r) = (&({left}), &({right})); {chosen('*l {} *r')} }})"
    if operator.endswith("="):
        left = left.replace("{", "{{").replace("}", "}}")
        return f"({{ let r = {right}; {chosen(f'{{{{ {left} {{}} r; }}}}')} }})"
    return f"({{ let (l, r) = ({left}, {right}); {chosen('l {} r')} }})"


def write(copy: Path, listed: list[dict[str, Any]], unviable: set[int]) -> set[int]:
    """Write the sources with choices; return the mutants that have one."""
    by_file = defaultdict(list)
    for number, entry in enumerate(listed, 1):
        if number not in unviable:
            by_file[entry["file"]].append((number, entry))
    core = copy / "rust/core/src"
    for path in core.glob("*.rs"):
        name = str(path.relative_to(copy))
        if (ROOT / name).is_file():
            file = File(ROOT / name, by_file[name])
            text = file.render(file.root)
            # Inlining everywhere would multiply the choices.
            path.write_text(text.replace("#[inline(always)]", "#[inline]"))
    library = (core / "lib.rs").read_text()
    allowed = "#![allow(warnings)]\npub mod mutant;"
    (core / "lib.rs").write_text(library.replace("#![forbid(unsafe_code)]", allowed))
    (core / "mutant.rs").write_text(CHOICE)
    # Only the machine's baseline, which is told below to have what the kernels need.
    level = (core / "level.rs").read_text()
    body = re.search(r"\(\$level:expr, \$run:expr\) => \{\{.*?\n    \}\};", level, re.DOTALL)
    assert body, "compiled_for! of level.rs looks different"
    (core / "level.rs").write_text(level.replace(body[0], "($level:expr, $run:expr) => { $run };"))
    return numbers("".join(path.read_text() for path in core.glob("*.rs")))


def refused(copy: Path, environment: dict[str, str]) -> set[int]:
    """The mutants that do not compile; none when all do."""
    check = ["cargo", "check", "--package", "cardan", "--message-format=json"]
    run = subprocess.run(check, cwd=copy, env=environment, capture_output=True, text=True)
    named, above = set(), set()
    for message in map(json.loads, run.stdout.splitlines()):
        if message["reason"] != "compiler-message" or message["message"]["level"] != "error":
            continue
        for span in filter(lambda span: span["is_primary"], message["message"]["spans"]):
            # Out of the macros of the standard library.
            while span["expansion"] and not (copy / span["file_name"]).is_file():
                span = span["expansion"]["span"]
            if (copy / span["file_name"]).is_file():
                lines = (copy / span["file_name"]).read_text().splitlines()[: span["line_start"]]
                named |= numbers(lines[-1])
                # What has another type than a choice before it.
                above |= next(filter(None, map(numbers, reversed(lines))), set())
    if run.returncode and not above:
        sys.exit(run.stderr)
    return named or above


def numbers(text: str) -> set[int]:
    return {int(number) for number in re.findall(r"/\*(\d+)\*/", text)}


def survives(programs: list[Path], copy: Path, number: int) -> bool:
    environment = {**os.environ, "MUTANT": str(number), "PROPTEST_MAX_SHRINK_ITERS": "0"}
    for program in programs:
        try:
            run = subprocess.run(
                [program, "--quiet"], cwd=copy, env=environment, capture_output=True, timeout=60
            )
        except subprocess.TimeoutExpired:
            return False
        if run.returncode:
            return False
    return True


def main(copy: Path) -> None:
    environment = {**os.environ, "CARGO_TARGET_DIR": str(copy / "target")}
    environment["RUSTFLAGS"] = "-C target-cpu=x86-64-v3"
    listing = ["cargo", "mutants", "--list", "--json", "--package", "cardan"]
    listed = json.loads(subprocess.check_output(listing, cwd=ROOT))
    subprocess.run(["git", "clone", "--quiet", ROOT, copy], check=True)
    with (copy / "Cargo.toml").open("a") as manifest:
        manifest.write(PROFILE)
    unviable: set[int] = set()
    switched = write(copy, listed, unviable)
    while bad := refused(copy, environment):
        unviable |= bad
        switched = write(copy, listed, unviable)
    rest = len(listed) - len(switched) - len(unviable)
    print(f"{len(listed)} mutants: {len(switched)} built, {len(unviable)} do not compile")
    print(f"{rest} in constants and the like want a build of their own (cargo mutants)")
    build = ["cargo", "test", "--package", "cardan", "--profile", "mutants", "--no-run"]
    run = subprocess.run(
        [*build, "--message-format=json"],
        cwd=copy,
        env=environment,
        check=True,
        capture_output=True,
    )
    artifacts = [json.loads(line) for line in run.stdout.splitlines()]
    programs = [Path(one["executable"]) for one in artifacts if one.get("executable")]
    extension = ["cargo", "build", "--package", "cardan-python", "--profile", "mutants"]
    subprocess.run(extension, cwd=copy, env=environment, check=True)
    library = copy / "target/mutants/lib_core.so"
    library.rename(copy / "python/cardan/_core.abi3.so")
    for number in sorted(switched):
        if survives(programs, copy, number):
            print(number, listed[number - 1]["name"], flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
