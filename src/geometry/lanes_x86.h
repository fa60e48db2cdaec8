/* The words of lanes.h for SSE4.2 (4 lanes), AVX2 (8) and AVX-512 (16). Meanings as in lanes_plain.h. */
#ifndef KDR_GEOMETRY_LANES_X86_H
#define KDR_GEOMETRY_LANES_X86_H

#include <immintrin.h>

#if KDR_LANES == 16

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_min(kdr_lanes_f a, kdr_lanes_f b) { return _mm512_min_ps(a, b); }

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_max(kdr_lanes_f a, kdr_lanes_f b) { return _mm512_max_ps(a, b); }

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_sooner(kdr_lanes_f a, kdr_lanes_f b) {
    return (kdr_lanes_f)_mm512_min_epi32((__m512i)a, (__m512i)b);
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_later(kdr_lanes_f a, kdr_lanes_f b) {
    return (kdr_lanes_f)_mm512_max_epi32((__m512i)a, (__m512i)b);
}

KDR_LANES_INLINE kdr_lane_bits kdr_lanes_less(kdr_lanes_f a, kdr_lanes_f b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_choose(kdr_lane_bits bits, kdr_lanes_f a, kdr_lanes_f b) {
    return _mm512_mask_blend_ps((__mmask16)bits, b, a);
}

/* Compressed in a register and stored under a mask: the compressing store itself is slow on some machines. */
KDR_LANES_INLINE void kdr_lanes_compress(float *to, kdr_lane_bits bits, kdr_lanes_f v) {
    __mmask16 first = (__mmask16)_bzhi_u32(0xffffu, (uint32_t)__builtin_popcount(bits));
    _mm512_mask_storeu_ps(to, first, _mm512_maskz_compress_ps((__mmask16)bits, v));
}

KDR_LANES_INLINE void kdr_lanes_compress_u(uint32_t *to, kdr_lane_bits bits, kdr_lanes_u v) {
    __mmask16 first = (__mmask16)_bzhi_u32(0xffffu, (uint32_t)__builtin_popcount(bits));
    _mm512_mask_storeu_epi32(to, first, _mm512_maskz_compress_epi32((__mmask16)bits, (__m512i)v));
}

/* The chosen lanes packed low, and zeros. */
KDR_LANES_INLINE kdr_lanes_f kdr_lanes_packed(kdr_lane_bits bits, kdr_lanes_f v) {
    return _mm512_maskz_compress_ps((__mmask16)bits, v);
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_load_first(const float *from, uint32_t count) {
    return _mm512_maskz_loadu_ps((__mmask16)_bzhi_u32(0xffffu, count < 16 ? count : 16), from);
}

/* 0, 1, 2 ... */
KDR_LANES_INLINE kdr_lanes_u kdr_lanes_count(void) {
    return (kdr_lanes_u)_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

/* Lanes that share a bit with `bits`. */
KDR_LANES_INLINE kdr_lane_bits kdr_lanes_share(kdr_lanes_u v, uint32_t bits) {
    return _mm512_test_epi32_mask((__m512i)v, _mm512_set1_epi32((int)bits));
}

/* Lane i is from[at[i]] where its bit is set. */
KDR_LANES_INLINE kdr_lanes_f kdr_lanes_gather(kdr_lane_bits bits, const float *from, kdr_lanes_u at) {
    return _mm512_mask_i32gather_ps(_mm512_setzero_ps(), (__mmask16)bits, (__m512i)at, from, 4);
}

/* to[at[i]] becomes lane i where its bit is set; of lanes for one place the highest one stays. */
KDR_LANES_INLINE void kdr_lanes_scatter(kdr_lane_bits bits, uint32_t *to, kdr_lanes_u at, kdr_lanes_u v) {
    _mm512_mask_i32scatter_epi32(to, (__mmask16)bits, (__m512i)at, (__m512i)v, 4);
}

KDR_LANES_INLINE kdr_lane_bits kdr_lanes_differ(kdr_lanes_u a, kdr_lanes_u b) {
    return _mm512_cmpneq_epi32_mask((__m512i)a, (__m512i)b);
}

/* Lane i is v[order[i] % 16]. */
KDR_LANES_INLINE kdr_lanes_f kdr_lanes_permute(kdr_lanes_f v, kdr_lanes_u order) {
    return _mm512_permutexvar_ps((__m512i)order, v);
}

/* Sixteen numbers of four bits in the low bits of each lane; what is above them has no meaning. Even ones come from the
 * lower half of the word, odd ones from the upper, the first lowest. */
KDR_LANES_INLINE kdr_lanes_u kdr_lanes_nibbles(const uint64_t *word) {
    const __m512i shift = _mm512_setr_epi32(0, 0, 4, 4, 8, 8, 12, 12, 16, 16, 20, 20, 24, 24, 28, 28);
    return (kdr_lanes_u)_mm512_srlv_epi32(_mm512_set1_epi64((long long)*word), shift);
}

#elif KDR_LANES == 8

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_min(kdr_lanes_f a, kdr_lanes_f b) { return _mm256_min_ps(a, b); }

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_max(kdr_lanes_f a, kdr_lanes_f b) { return _mm256_max_ps(a, b); }

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_sooner(kdr_lanes_f a, kdr_lanes_f b) {
    return (kdr_lanes_f)_mm256_min_epi32((__m256i)a, (__m256i)b);
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_later(kdr_lanes_f a, kdr_lanes_f b) {
    return (kdr_lanes_f)_mm256_max_epi32((__m256i)a, (__m256i)b);
}

KDR_LANES_INLINE kdr_lane_bits kdr_lanes_less(kdr_lanes_f a, kdr_lanes_f b) {
    return (kdr_lane_bits)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ));
}

/* -1 in the lanes whose bit is set. */
KDR_LANES_INLINE __m256i kdr_lanes_spread(kdr_lane_bits bits) {
    __m256i place = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    return _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)bits), place), place);
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_choose(kdr_lane_bits bits, kdr_lanes_f a, kdr_lanes_f b) {
    return _mm256_blendv_ps(b, a, _mm256_castsi256_ps(kdr_lanes_spread(bits)));
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_load_first(const float *from, uint32_t count) {
    return _mm256_maskload_ps(from, kdr_lanes_spread((1u << (count < 8 ? count : 8)) - 1));
}

/* Lane numbers of the set bits, packed low: parallel extract of bytes, widened. */
KDR_LANES_INLINE __m256i kdr_lanes_pack_order(kdr_lane_bits bits) {
    uint64_t bytes = _pdep_u64(bits, 0x0101010101010101u) * 0xffu;
    uint64_t order = _pext_u64(0x0706050403020100u, bytes);
    return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)order));
}

KDR_LANES_INLINE void kdr_lanes_compress_u(uint32_t *to, kdr_lane_bits bits, kdr_lanes_u v) {
    __m256i packed = _mm256_permutevar8x32_epi32((__m256i)v, kdr_lanes_pack_order(bits));
    __m256i first = kdr_lanes_spread((1u << __builtin_popcount(bits)) - 1);
    _mm256_maskstore_epi32((int *)to, first, packed);
}

KDR_LANES_INLINE void kdr_lanes_compress(float *to, kdr_lane_bits bits, kdr_lanes_f v) {
    kdr_lanes_compress_u((uint32_t *)to, bits, (kdr_lanes_u)v);
}

#elif KDR_LANES == 4

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_min(kdr_lanes_f a, kdr_lanes_f b) { return _mm_min_ps(a, b); }

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_max(kdr_lanes_f a, kdr_lanes_f b) { return _mm_max_ps(a, b); }

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_sooner(kdr_lanes_f a, kdr_lanes_f b) {
    return (kdr_lanes_f)_mm_min_epi32((__m128i)a, (__m128i)b);
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_later(kdr_lanes_f a, kdr_lanes_f b) {
    return (kdr_lanes_f)_mm_max_epi32((__m128i)a, (__m128i)b);
}

KDR_LANES_INLINE kdr_lane_bits kdr_lanes_less(kdr_lanes_f a, kdr_lanes_f b) {
    return (kdr_lane_bits)_mm_movemask_ps(_mm_cmplt_ps(a, b));
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_load_first(const float *from, uint32_t count) {
    (void)count;
    return _mm_loadu_ps(from);
}

KDR_LANES_INLINE kdr_lanes_f kdr_lanes_choose(kdr_lane_bits bits, kdr_lanes_f a, kdr_lanes_f b) {
    __m128i place = _mm_setr_epi32(1, 2, 4, 8);
    __m128i spread = _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32((int)bits), place), place);
    return _mm_blendv_ps(b, a, _mm_castsi128_ps(spread));
}

KDR_LANES_INLINE void kdr_lanes_compress_u(uint32_t *to, kdr_lane_bits bits, kdr_lanes_u v) {
    for (; bits; bits &= bits - 1)
        *to++ = v[__builtin_ctz(bits)];
}

KDR_LANES_INLINE void kdr_lanes_compress(float *to, kdr_lane_bits bits, kdr_lanes_f v) {
    for (; bits; bits &= bits - 1)
        *to++ = v[__builtin_ctz(bits)];
}

#endif

#endif
