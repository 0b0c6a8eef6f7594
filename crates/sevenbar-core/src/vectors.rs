//! Eight numbers in the machine's vector registers, for code whose lanes are too entangled for the compiler to find them.
//!
//! With [`crate::simd`] the only place of `unsafe`: instructions of a vector unit are used by types that are only made after the
//! unit was seen at run time.

#![allow(unsafe_code)]

use crate::number::Number;
use crate::vector_math::sin_cos_side_by_side;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{
    __m256d, __m512d, _CMP_GT_OQ, _mm256_add_pd, _mm256_blendv_pd, _mm256_cmp_pd, _mm256_div_pd,
    _mm256_fmadd_pd, _mm256_fnmadd_pd, _mm256_loadu_pd, _mm256_movemask_pd, _mm256_mul_pd, _mm256_set1_pd,
    _mm256_sqrt_pd, _mm256_storeu_pd, _mm256_sub_pd, _mm512_add_pd, _mm512_cmp_pd_mask, _mm512_div_pd,
    _mm512_fmadd_pd, _mm512_fnmadd_pd, _mm512_loadu_pd, _mm512_mask_blend_pd, _mm512_mul_pd, _mm512_set1_pd,
    _mm512_sqrt_pd, _mm512_storeu_pd, _mm512_sub_pd,
};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// How many numbers stand side by side.
pub(crate) const LANES: usize = 8;

/// One number for each lane.
pub(crate) type Reals = [f64; LANES];

/// Eight numbers on which one instruction works (or a few, on lesser machines).
pub(crate) trait Vector: Number {
    /// A number for each lane.
    fn load(x: &Reals) -> Self;
    /// The numbers of the lanes.
    fn store(self) -> Reals;
    /// Whether `self > b` in some lane.
    fn exceeds_somewhere(self, b: Self) -> bool;
}

/// Code to be compiled once for each vector unit. Implementations are `#[inline(always)]`.
pub(crate) trait LaneKernel {
    /// Runs it.
    fn run<V: Vector>(self);
}

/// Operators of a type, each by an expression of two names. Closures would not be compiled for the vector unit.
macro_rules! operators {
    ($kind:ident, $a:ident, $b:ident, $($operator:ident $name:ident $value:expr),*) => {
        $(
            impl $operator for $kind {
                type Output = Self;
                #[inline(always)]
                fn $name(self, b: Self) -> Self {
                    let ($a, $b) = (self, b);
                    $value
                }
            }
        )*
        impl Neg for $kind {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::splat(0.0) - self
            }
        }
    };
}

/// Eight numbers as the compiler sees fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain(Reals);

/// Operators of [`Plain`]. On x86, where it serves machines without AVX2, each is compiled once and called: written out in every kernel
/// they would be a fifth of the library. Elsewhere it is the only kind.
macro_rules! plain {
    ($($operator:ident $name:ident $by:tt),*) => {
        $(
            impl $operator for Plain {
                type Output = Self;
                #[cfg_attr(target_arch = "x86_64", inline(never))]
                #[cfg_attr(not(target_arch = "x86_64"), inline(always))]
                fn $name(self, b: Self) -> Self {
                    Self(std::array::from_fn(|k| self.0[k] $by b.0[k]))
                }
            }
        )*
    };
}

plain!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Neg for Plain {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::splat(0.0) - self
    }
}

impl Number for Plain {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; LANES])
    }
    #[cfg_attr(target_arch = "x86_64", inline(never))]
    #[cfg_attr(not(target_arch = "x86_64"), inline(always))]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }
    #[cfg_attr(target_arch = "x86_64", inline(never))]
    #[cfg_attr(not(target_arch = "x86_64"), inline(always))]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }
    #[cfg_attr(target_arch = "x86_64", inline(never))]
    #[cfg_attr(not(target_arch = "x86_64"), inline(always))]
    fn if_greater(self, b: Self, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|k| {
            if self.0[k] > b.0[k] { yes.0[k] } else { no.0[k] }
        }))
    }
    #[cfg_attr(target_arch = "x86_64", inline(never))]
    #[cfg_attr(not(target_arch = "x86_64"), inline(always))]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos_side_by_side(self)
    }
}

impl Vector for Plain {
    #[inline(always)]
    fn load(x: &Reals) -> Self {
        Self(*x)
    }
    #[inline(always)]
    fn store(self) -> Reals {
        self.0
    }
    #[inline(always)]
    fn exceeds_somewhere(self, b: Self) -> bool {
        (0..LANES).any(|k| self.0[k] > b.0[k])
    }
}

/// One register of AVX-512.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug)]
struct Wide(__m512d);

/// Two registers of AVX2.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug)]
struct Middle([__m256d; 2]);

// SAFETY of all blocks below: the types are private and only [`dispatch`] names them, after it saw the unit
#[cfg(target_arch = "x86_64")]
operators!(
    Wide,
    a,
    b,
    Add add Self(unsafe { _mm512_add_pd(a.0, b.0) }),
    Sub sub Self(unsafe { _mm512_sub_pd(a.0, b.0) }),
    Mul mul Self(unsafe { _mm512_mul_pd(a.0, b.0) }),
    Div div Self(unsafe { _mm512_div_pd(a.0, b.0) })
);

#[cfg(target_arch = "x86_64")]
impl Number for Wide {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(x) })
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Self(unsafe { _mm512_fmadd_pd(a.0, b.0, self.0) })
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Self(unsafe { _mm512_fnmadd_pd(a.0, b.0, self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn if_greater(self, b: Self, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_pd(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, b.0), no.0, yes.0) })
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos_side_by_side(self)
    }
}

#[cfg(target_arch = "x86_64")]
impl Vector for Wide {
    #[inline(always)]
    fn load(x: &Reals) -> Self {
        Self(unsafe { _mm512_loadu_pd(x.as_ptr()) })
    }
    #[inline(always)]
    fn store(self) -> Reals {
        let mut x = [0.0; LANES];
        unsafe { _mm512_storeu_pd(x.as_mut_ptr(), self.0) };
        x
    }
    #[inline(always)]
    fn exceeds_somewhere(self, b: Self) -> bool {
        (unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, b.0) }) != 0
    }
}

#[cfg(target_arch = "x86_64")]
operators!(
    Middle,
    a,
    b,
    Add add Self(unsafe { [_mm256_add_pd(a.0[0], b.0[0]), _mm256_add_pd(a.0[1], b.0[1])] }),
    Sub sub Self(unsafe { [_mm256_sub_pd(a.0[0], b.0[0]), _mm256_sub_pd(a.0[1], b.0[1])] }),
    Mul mul Self(unsafe { [_mm256_mul_pd(a.0[0], b.0[0]), _mm256_mul_pd(a.0[1], b.0[1])] }),
    Div div Self(unsafe { [_mm256_div_pd(a.0[0], b.0[0]), _mm256_div_pd(a.0[1], b.0[1])] })
);

#[cfg(target_arch = "x86_64")]
impl Number for Middle {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([unsafe { _mm256_set1_pd(x) }; 2])
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Self(unsafe {
            [
                _mm256_fmadd_pd(a.0[0], b.0[0], self.0[0]),
                _mm256_fmadd_pd(a.0[1], b.0[1], self.0[1]),
            ]
        })
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Self(unsafe {
            [
                _mm256_fnmadd_pd(a.0[0], b.0[0], self.0[0]),
                _mm256_fnmadd_pd(a.0[1], b.0[1], self.0[1]),
            ]
        })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { [_mm256_sqrt_pd(self.0[0]), _mm256_sqrt_pd(self.0[1])] })
    }
    #[inline(always)]
    fn if_greater(self, b: Self, yes: Self, no: Self) -> Self {
        Self(unsafe {
            [
                _mm256_blendv_pd(no.0[0], yes.0[0], _mm256_cmp_pd::<_CMP_GT_OQ>(self.0[0], b.0[0])),
                _mm256_blendv_pd(no.0[1], yes.0[1], _mm256_cmp_pd::<_CMP_GT_OQ>(self.0[1], b.0[1])),
            ]
        })
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos_side_by_side(self)
    }
}

#[cfg(target_arch = "x86_64")]
impl Vector for Middle {
    #[inline(always)]
    fn load(x: &Reals) -> Self {
        Self(unsafe { [_mm256_loadu_pd(x.as_ptr()), _mm256_loadu_pd(x.as_ptr().add(4))] })
    }
    #[inline(always)]
    fn store(self) -> Reals {
        let mut x = [0.0; LANES];
        unsafe {
            _mm256_storeu_pd(x.as_mut_ptr(), self.0[0]);
            _mm256_storeu_pd(x.as_mut_ptr().add(4), self.0[1]);
        }
        x
    }
    #[inline(always)]
    fn exceeds_somewhere(self, b: Self) -> bool {
        let greater =
            |k: usize| unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(self.0[k], b.0[k])) };
        greater(0) | greater(1) != 0
    }
}

/// How many numbers stand side by side in a quad.
pub(crate) const QUAD: usize = 4;

/// Four numbers on which one instruction works.
pub(crate) trait Four: Number {
    /// A number for each lane.
    fn load(x: &[f64; QUAD]) -> Self;
    /// The numbers of the lanes.
    fn store(self) -> [f64; QUAD];
}

/// Code to be compiled for registers of four numbers. Implementations are `#[inline(always)]`.
pub(crate) trait QuadKernel {
    /// Runs it.
    fn run<F: Four>(self);
}

/// One register of AVX2: half the instructions of eight lanes, for code that is long and not run through often.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug)]
struct Quad(__m256d);

#[cfg(target_arch = "x86_64")]
operators!(
    Quad,
    a,
    b,
    Add add Self(unsafe { _mm256_add_pd(a.0, b.0) }),
    Sub sub Self(unsafe { _mm256_sub_pd(a.0, b.0) }),
    Mul mul Self(unsafe { _mm256_mul_pd(a.0, b.0) }),
    Div div Self(unsafe { _mm256_div_pd(a.0, b.0) })
);

#[cfg(target_arch = "x86_64")]
impl Number for Quad {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(x) })
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Self(unsafe { _mm256_fmadd_pd(a.0, b.0, self.0) })
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Self(unsafe { _mm256_fnmadd_pd(a.0, b.0, self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn if_greater(self, b: Self, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm256_blendv_pd(no.0, yes.0, _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, b.0)) })
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos_side_by_side(self)
    }
}

#[cfg(target_arch = "x86_64")]
impl Four for Quad {
    #[inline(always)]
    fn load(x: &[f64; QUAD]) -> Self {
        Self(unsafe { _mm256_loadu_pd(x.as_ptr()) })
    }
    #[inline(always)]
    fn store(self) -> [f64; QUAD] {
        let mut x = [0.0; QUAD];
        unsafe { _mm256_storeu_pd(x.as_mut_ptr(), self.0) };
        x
    }
}

/// Runs a kernel on registers of four numbers, and says whether the machine has them.
#[cfg(target_arch = "x86_64")]
pub(crate) fn dispatch_quads<K: QuadKernel>(kernel: K) -> bool {
    #[target_feature(enable = "avx2,fma")]
    fn quads<K: QuadKernel>(kernel: K) {
        kernel.run::<Quad>();
    }
    let has_quads = matches!(crate::simd::level(), "avx512" | "avx2");
    if has_quads {
        // SAFETY: the unit was seen on this machine just now
        unsafe { quads(kernel) };
    }
    has_quads
}

/// Says that the machine has no registers of four numbers.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn dispatch_quads<K: QuadKernel>(_kernel: K) -> bool {
    false
}

/// Runs a kernel on the best vector unit at hand.
#[cfg(target_arch = "x86_64")]
pub(crate) fn dispatch<K: LaneKernel>(kernel: K) {
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,fma")]
    fn wide<K: LaneKernel>(kernel: K) {
        kernel.run::<Wide>();
    }
    #[target_feature(enable = "avx2,fma")]
    fn middle<K: LaneKernel>(kernel: K) {
        kernel.run::<Middle>();
    }
    match crate::simd::level() {
        // SAFETY: the unit was seen on this machine just now
        "avx512" => unsafe { wide(kernel) },
        // SAFETY: as above
        "avx2" => unsafe { middle(kernel) },
        _ => kernel.run::<Plain>(),
    }
}

/// Runs a kernel as the compiler vectorises it.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn dispatch<K: LaneKernel>(kernel: K) {
    kernel.run::<Plain>();
}
