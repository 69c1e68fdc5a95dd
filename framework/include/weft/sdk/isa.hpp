// SPDX-License-Identifier: Apache-2.0
#pragma once

// The compiler, and the processor features that it was told to assume beyond x86-64.

#ifdef __clang__
#define WEFT_COMPILER "clang " __clang_version__
#else
#define WEFT_COMPILER "gcc " __VERSION__
#endif

#ifdef __SSE4_2__
#define WEFT_ISA_SSE42 "sse4.2 "
#else
#define WEFT_ISA_SSE42 ""
#endif
#ifdef __AVX__
#define WEFT_ISA_AVX "avx "
#else
#define WEFT_ISA_AVX ""
#endif
#ifdef __AVX2__
#define WEFT_ISA_AVX2 "avx2 "
#else
#define WEFT_ISA_AVX2 ""
#endif
#ifdef __FMA__
#define WEFT_ISA_FMA "fma "
#else
#define WEFT_ISA_FMA ""
#endif
#ifdef __BMI2__
#define WEFT_ISA_BMI2 "bmi2 "
#else
#define WEFT_ISA_BMI2 ""
#endif
#ifdef __AVX512F__
#define WEFT_ISA_AVX512F "avx512f "
#else
#define WEFT_ISA_AVX512F ""
#endif

#define WEFT_ISA \
  WEFT_ISA_SSE42 WEFT_ISA_AVX WEFT_ISA_AVX2 WEFT_ISA_FMA WEFT_ISA_BMI2 WEFT_ISA_AVX512F
