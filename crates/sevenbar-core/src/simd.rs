//! Runs a loop compiled for the widest vector unit that the machine has.
//!
//! `unsafe` here, and in [`crate::vectors`] alone besides: a function compiled for a vector unit may be called once the unit was seen
//! at run time. The loops themselves are ordinary Rust, written without branches so that the compiler turns them into vector code.

/// A loop to be compiled once for each vector unit.
pub(crate) trait Kernel {
    /// Runs the loop. `FUSED` says that `f64::mul_add` is one instruction.
    ///
    /// Implementations are `#[inline(always)]`, or they are compiled for the least machine only.
    fn run<const FUSED: bool>(self);
}

/// `a b + c`, rounded once where that is one instruction.
#[inline(always)]
pub(crate) fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// Runs a kernel on the best vector unit at hand.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
pub(crate) fn dispatch<K: Kernel>(kernel: K) {
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,fma")]
    fn wide<K: Kernel>(kernel: K) {
        kernel.run::<true>();
    }
    #[target_feature(enable = "avx2,fma")]
    fn middle<K: Kernel>(kernel: K) {
        kernel.run::<true>();
    }
    match level() {
        // SAFETY: the unit was seen on this machine just now
        "avx512" => unsafe { wide(kernel) },
        // SAFETY: as above
        "avx2" => unsafe { middle(kernel) },
        _ => kernel.run::<false>(),
    }
}

/// Runs a kernel; 64-bit ARM has fused multiply-add and its vector unit in every machine.
#[cfg(target_arch = "aarch64")]
pub(crate) fn dispatch<K: Kernel>(kernel: K) {
    kernel.run::<true>();
}

/// Runs a kernel as compiled for the least machine.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
pub(crate) fn dispatch<K: Kernel>(kernel: K) {
    kernel.run::<false>();
}

/// The name of the vector unit that [`dispatch`] uses.
pub fn level() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("fma")
        {
            return "avx512";
        }
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            return "avx2";
        }
    }
    if cfg!(target_arch = "aarch64") {
        "neon"
    } else {
        "plain"
    }
}
