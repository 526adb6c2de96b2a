//! The instruction sets that the kernels are compiled for.

pub use fearless_simd::Level;
use fearless_simd::Simd;

/// Runs the expression compiled for the level. Levels before AVX2 have no fused multiply-add and
/// gain nothing over the baseline of the machine. Outside x86 the baseline has everything that the
/// kernels need.
macro_rules! compiled_for {
    ($level:expr, $run:expr) => {{
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            use fearless_simd::Simd;
            if let Some(simd) = $level.as_avx512() {
                simd.vectorize(
                    #[inline(always)]
                    || $run,
                )
            } else if let Some(simd) = $level.as_avx2() {
                simd.vectorize(
                    #[inline(always)]
                    || $run,
                )
            } else {
                $run
            }
        }
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        {
            let _ = $level;
            $run
        }
    }};
}
pub(crate) use compiled_for;

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
