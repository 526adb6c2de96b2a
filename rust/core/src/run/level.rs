//! The instruction sets that the kernels are compiled for.

use cardan_memory::Stores;
pub use fearless_simd::Level;
#[cfg(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64"))]
use fearless_simd::Simd;

use crate::error::{Error, Result};

/// Runs the expression compiled for the level. Levels before AVX2 have no fused multiply-add and
/// gain nothing over the baseline of the machine. Outside x86 the baseline has everything that the
/// kernels need, but for WebAssembly, which has no fused multiply-add.
///
/// `compact` and `stores` are constants in each copy of the expression: see [`is_compact`], and how
/// strips are stored.
macro_rules! compiled_for {
    ($level:expr, $run:expr) => {
        compiled_for!($level, (_compact, _stores) => $run)
    };
    ($level:expr, ($compact:ident, $stores:ident) => $run:expr) => {{
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            use fearless_simd::Simd;
            if let Some(simd) = $level.as_avx512() {
                simd.vectorize(
                    #[inline(always)]
                    || {
                        let ($compact, $stores) = (false, cardan_memory::Stores::avx512(simd));
                        $run
                    },
                )
            } else {
                $crate::run::level::compiled_up_to_avx2!($level, ($compact, $stores) => $run)
            }
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        $crate::run::level::compiled_up_to_avx2!($level, ($compact, $stores) => $run)
    }};
}
pub(crate) use compiled_for;

/// The same without AVX-512, for what gains nothing from it.
macro_rules! compiled_up_to_avx2 {
    ($level:expr, $run:expr) => {
        compiled_up_to_avx2!($level, (_compact, _stores) => $run)
    };
    ($level:expr, ($compact:ident, $stores:ident) => $run:expr) => {{
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            use fearless_simd::Simd;
            if let Some(simd) = $level.as_avx2() {
                simd.vectorize(
                    #[inline(always)]
                    || {
                        let ($compact, $stores) = (false, cardan_memory::Stores::avx2(simd));
                        $run
                    },
                )
            } else {
                let ($compact, $stores) = (true, cardan_memory::Stores::ordinary());
                $run
            }
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        {
            let _: &fearless_simd::Level = &$level;
            let compact = cfg!(target_family = "wasm");
            let ($compact, $stores) = (compact, cardan_memory::Stores::ordinary());
            $run
        }
    }};
}
pub(crate) use compiled_up_to_avx2;

/// Whether the kernels for this level are few loops instead of fast ones. Without fused multiply-add
/// each product-sum is a function call, which costs more time than they save, and whose code takes
/// more space than that of any other level.
pub(crate) fn is_compact(level: Level) -> bool {
    compiled_for!(level, (compact, _stores) => compact)
}

/// Whether the registers of this level hold a cache line.
pub(crate) fn has_wide_registers(level: Level) -> bool {
    compiled_for!(level, (_compact, stores) => stores.has_wide_registers())
}

/// A number type whose kernels form a compilation unit.
///
/// The compiler works on several units at once. A unit is a module: a generic function belongs to
/// the module that defines it, whatever types it is compiled for.
pub(crate) trait Compiled {
    /// Runs the kernel compiled for the level, and tells it whether it [`is_compact`] and how it
    /// stores strips. It is an `FnMut` so that it is borrowed and not moved into the function for
    /// the level: a copy would load in pairs what has just been stored one by one, and such loads
    /// wait for the stores.
    fn run<R>(level: Level, kernel: impl FnMut(bool, Stores) -> R) -> R;
}

macro_rules! compiled_in {
    ($($unit:ident: $number:ty;)*) => {$(
        mod $unit {
            use super::{Compiled, Level, Stores};

            impl Compiled for $number {
                #[inline(never)]
                fn run<R>(level: Level, mut kernel: impl FnMut(bool, Stores) -> R) -> R {
                    compiled_for!(level, (compact, stores) => kernel(compact, stores))
                }
            }
        }
    )*};
}

compiled_in! {
    single: f32;
    double: f64;
    double_double: crate::number::double_double::DoubleDouble;
}

/// Every level that this machine can run, strongest first, with its name.
///
/// ```
/// let levels = cardan::level::available();
/// assert!(!levels.is_empty());
/// ```
pub fn available() -> Vec<(&'static str, Level)> {
    let best = Level::new();
    let mut levels = Vec::new();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_avx512().map(|token| ("avx512", token.level())));
        levels.extend(best.as_avx2().map(|token| ("avx2", token.level())));
        levels.extend(best.as_sse4_2().map(|token| ("sse4.2", token.level())));
        levels.extend(best.as_sse2().map(|token| ("sse2", token.level())));
    }
    #[cfg(target_arch = "aarch64")]
    levels.extend(best.as_neon().map(|token| ("neon", token.level())));
    if levels.is_empty() {
        levels.push(("fallback", best));
    }
    levels
}

/// The level with this name.
///
/// # Errors
/// A level that this machine cannot run, or an unknown name.
pub fn named(name: &str) -> Result<Level> {
    let found = available().into_iter().find(|(known, _)| *known == name);
    let missing = || Error::new("level", &[], format!("{name:?} is not available here"));
    found.map(|(_, level)| level).ok_or_else(missing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_has_a_name() {
        for (name, _) in available() {
            assert!(named(name).is_ok());
        }
        let error = named("abacus").unwrap_err();
        assert_eq!(error.to_string(), "level \"abacus\" is not available here");
    }
}
