//! The core as a WebAssembly module: plain functions over the memory of the module.
//!
//! [`describe`] answers with the table of what can be called: for each function the arguments and
//! results with their names, units and shapes, and the names that numbers stand for. A call takes
//! three steps: [`room`] returns where the arguments go, the caller writes them there, and [`call`]
//! computes. Arguments and results have the same form: for each one how many numbers it has, and
//! then these. The answer is at [`answer`], [`answer_length`] bytes long: the results, or an error
//! as JSON in UTF-8.
//!
//! The module keeps nothing from one call to the next but the room for both and a search.

mod arguments;
mod design;
pub mod fma;
mod geometry;
mod judge;
mod lateral;
mod motion;
mod table;
mod torsion;

use std::cell::RefCell;

use table::FUNCTIONS;

/// The most numbers of arguments, and of results: more do not help a page, and memory never shrinks.
const MOST: usize = 1 << 22;

/// How a call ended.
#[derive(Clone, Copy)]
enum Ending {
    Results,
    Error,
}

thread_local! {
    static ARGUMENTS: RefCell<Vec<f64>> = const { RefCell::new(vec![]) };
    static ANSWER: RefCell<Vec<u8>> = const { RefCell::new(vec![]) };
}

/// Makes room for so many numbers of arguments and returns where it is; 0 if there is none.
// SAFETY: no other function of a page's module has this name; the same holds for those below.
#[unsafe(no_mangle)]
pub extern "C" fn room(count: usize) -> usize {
    ARGUMENTS.with_borrow_mut(|arguments| {
        arguments.clear();
        if count > MOST || arguments.try_reserve_exact(count).is_err() {
            return 0;
        }
        arguments.resize(count, 0.0);
        arguments.as_mut_ptr().addr()
    })
}

/// Calls a function by its number with the arguments in the room; 0 if the answer is its results, 1
/// if it is an error.
#[unsafe(no_mangle)]
pub extern "C" fn call(function: usize) -> usize {
    let found = ARGUMENTS.with_borrow(|arguments| called(function, arguments));
    let (ending, bytes) = match found {
        Ok(results) => (Ending::Results, results.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Err(error) => (Ending::Error, told(&error).into_bytes()),
    };
    ANSWER.set(bytes);
    ending as usize
}

/// Answers with the table of functions as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn describe() {
    ANSWER.set(table::described().into_bytes());
}

/// Where the answer is.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    ANSWER.with_borrow(|bytes| bytes.as_ptr().addr())
}

/// How many bytes it has.
#[unsafe(no_mangle)]
pub extern "C" fn answer_length() -> usize {
    ANSWER.with_borrow(Vec::len)
}

/// An error as JSON: its sentence, the argument, the place in it, and where a value breaks a rule the
/// value, its unit and the rule. JSON has no NaN and no infinity: such a value is a string.
fn told(error: &cardan::Error) -> String {
    let cardan::Error { argument, place, problem } = error;
    let place = &place.0;
    let broken = match problem {
        cardan::Problem::Value { value, rule } => {
            let cardan::Rule { unit, text, .. } = rule;
            let value =
                if value.is_finite() { format!("{value:?}") } else { format!("\"{value}\"") };
            format!(",\"value\":{value},\"unit\":{unit:?},\"rule\":{text:?}")
        }
        cardan::Problem::Words(_) => String::new(),
    };
    let message = error.to_string();
    format!("{{\"message\":{message:?},\"argument\":{argument:?},\"place\":{place:?}{broken}}}")
}

/// The results of a function for arguments, in the form of both.
///
/// # Errors
/// A function that does not exist, arguments that it refuses, more results than a page can use.
pub fn called(function: usize, arguments: &[f64]) -> cardan::Result<Vec<f64>> {
    let unknown = || cardan::Error::new("function", &[], format!("{function} does not exist"));
    let function = FUNCTIONS.get(function).ok_or_else(unknown)?;
    let results = (function.call)(&arguments::Arguments::read(function, arguments)?)?;
    debug_assert_eq!(results.len(), function.results.len(), "{}", function.name);
    let mut flat = Vec::with_capacity(results.iter().map(|result| 1 + result.len()).sum());
    for result in results {
        flat.push(result.len() as f64);
        flat.extend(result);
    }
    Ok(flat)
}
