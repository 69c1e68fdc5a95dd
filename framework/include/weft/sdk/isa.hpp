// SPDX-License-Identifier: Apache-2.0
#pragma once

// The compiler, and the processor features beyond x86-64 that it was allowed to assume, as option
// names (-mavx2). Omitted are features that compilers do not use on their own and numeric code does
// not request: caches, transactions, interrupts and protection keys.

#ifdef __clang__
#define WEFT_COMPILER "clang " __clang_version__
#else
#define WEFT_COMPILER "gcc " __VERSION__
#endif

namespace weft::detail {

/// Features of this file, which may be compiled with different options than others.
[[maybe_unused]] constexpr char kIsa[] =
    ""
#ifdef __SSE3__
    "sse3 "
#endif
#ifdef __SSSE3__
    "ssse3 "
#endif
#ifdef __SSE4_1__
    "sse4.1 "
#endif
#ifdef __SSE4_2__
    "sse4.2 "
#endif
#ifdef __SSE4A__
    "sse4a "
#endif
#ifdef __POPCNT__
    "popcnt "
#endif
#ifdef __LZCNT__
    "lzcnt "
#endif
#ifdef __BMI__
    "bmi "
#endif
#ifdef __BMI2__
    "bmi2 "
#endif
#ifdef __TBM__
    "tbm "
#endif
#ifdef __MOVBE__
    "movbe "
#endif
#ifdef __ADX__
    "adx "
#endif
#ifdef __GCC_HAVE_SYNC_COMPARE_AND_SWAP_16
    "cx16 "
#endif
#ifdef __LAHF_SAHF__
    "sahf "
#endif
#ifdef __CMPCCXADD__
    "cmpccxadd "
#endif
#ifdef __AES__
    "aes "
#endif
#ifdef __PCLMUL__
    "pclmul "
#endif
#ifdef __SHA__
    "sha "
#endif
#ifdef __GFNI__
    "gfni "
#endif
#ifdef __RDRND__
    "rdrnd "
#endif
#ifdef __RDSEED__
    "rdseed "
#endif
#ifdef __AVX__
    "avx "
#endif
#ifdef __AVX2__
    "avx2 "
#endif
#ifdef __FMA__
    "fma "
#endif
#ifdef __FMA4__
    "fma4 "
#endif
#ifdef __XOP__
    "xop "
#endif
#ifdef __F16C__
    "f16c "
#endif
#ifdef __VAES__
    "vaes "
#endif
#ifdef __VPCLMULQDQ__
    "vpclmulqdq "
#endif
#ifdef __AVXVNNI__
    "avxvnni "
#endif
#ifdef __AVXIFMA__
    "avxifma "
#endif
#ifdef __AVXVNNIINT8__
    "avxvnniint8 "
#endif
#ifdef __AVXVNNIINT16__
    "avxvnniint16 "
#endif
#ifdef __AVXNECONVERT__
    "avxneconvert "
#endif
#ifdef __SHA512__
    "sha512 "
#endif
#ifdef __SM3__
    "sm3 "
#endif
#ifdef __SM4__
    "sm4 "
#endif
#ifdef __AVX512F__
    "avx512f "
#endif
#ifdef __AVX512CD__
    "avx512cd "
#endif
#ifdef __AVX512VL__
    "avx512vl "
#endif
#ifdef __AVX512BW__
    "avx512bw "
#endif
#ifdef __AVX512DQ__
    "avx512dq "
#endif
#ifdef __AVX512IFMA__
    "avx512ifma "
#endif
#ifdef __AVX512VBMI__
    "avx512vbmi "
#endif
#ifdef __AVX512VBMI2__
    "avx512vbmi2 "
#endif
#ifdef __AVX512VNNI__
    "avx512vnni "
#endif
#ifdef __AVX512BITALG__
    "avx512bitalg "
#endif
#ifdef __AVX512VPOPCNTDQ__
    "avx512vpopcntdq "
#endif
#ifdef __AVX512BF16__
    "avx512bf16 "
#endif
#ifdef __AVX512FP16__
    "avx512fp16 "
#endif
#ifdef __AVX512VP2INTERSECT__
    "avx512vp2intersect "
#endif
#ifdef __AVX512ER__
    "avx512er "
#endif
#ifdef __AVX512PF__
    "avx512pf "
#endif
#ifdef __AMX_TILE__
    "amx-tile "
#endif
#ifdef __AMX_INT8__
    "amx-int8 "
#endif
#ifdef __AMX_BF16__
    "amx-bf16 "
#endif
#ifdef __AMX_FP16__
    "amx-fp16 "
#endif
#ifdef __AMX_COMPLEX__
    "amx-complex "
#endif
#ifdef __APX_F__
    "apxf "
#endif
    ;

}  // namespace weft::detail

#define WEFT_ISA ::weft::detail::kIsa
