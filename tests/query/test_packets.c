/* Packets of 4, 8 and 16 rays, and rays of one call that go together, give the bits that kdr_intersect1 gives on the
 * plainest instruction set, and leave alone what is not theirs. Awkward rays and the oracle: see query_sheet.h. */
#include "support/everywhere.h"
#include "support/soup.h"
#include "support/test_size.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define TRIANGLES TEST_SIZE(3000)
#define BUNDLES TEST_SIZE(300) /* of each kind */
#define BUNDLE 64

/* What rays of a bundle share. */
typedef enum bundle_kind {
    FROM_ONE_POINT,
    TO_ONE_POINT,
    PARALLEL,
    ALONG_AN_AXIS,    /* within a hair of it, so that signs and zeros differ */
    ALONG_A_DIAGONAL, /* so that the longest axis differs */
    EVERYWHERE,
    SHORT, /* intervals that end amid the triangles */
    BUNDLE_KINDS
} bundle_kind;

static void set(float *to, const float from[3]) { memcpy(to, from, 3 * sizeof *from); }

static kdr_ray bundle_ray(test_random *random, bundle_kind kind, const float apex[3], const float towards[3]) {
    kdr_ray ray = {.tmin = 0, .tmax = INFINITY, .id = test_random_u32(random)};
    float origin[3], direction[3];
    for (int k = 0; k < 3; k++) {
        float jitter = test_random_between(random, -0.05f, 0.05f);
        origin[k] = apex[k];
        direction[k] = towards[k] - apex[k] + jitter;
        switch (kind) {
        case TO_ONE_POINT:
            origin[k] = apex[k] + test_random_between(random, -0.1f, 0.1f);
            direction[k] = towards[k] - origin[k];
            ray.tmax = 0.9999f;
            break;
        case PARALLEL:
            origin[k] = apex[k] + jitter;
            direction[k] = towards[k] - apex[k];
            break;
        case ALONG_AN_AXIS:
            direction[k] = k == 1 ? -1 : (float)((int)test_random_below(random, 5) - 2) * 0x1p-6f;
            break;
        case ALONG_A_DIAGONAL: direction[k] = 1 + jitter; break;
        case EVERYWHERE: direction[k] = test_random_between(random, -1, 1); break;
        default: break;
        }
    }
    if (kind == SHORT) {
        ray.tmin = test_random_between(random, 0, 0.5f);
        ray.tmax = test_random_between(random, 0.4f, 1);
    }
    set(&ray.origin_x, origin);
    set(&ray.direction_x, direction);
    return ray;
}

static void make_bundle(test_random *random, bundle_kind kind, kdr_ray rays[BUNDLE]) {
    float apex[3], towards[3];
    for (int k = 0; k < 3; k++) {
        apex[k] = test_random_between(random, -1.5f, 1.5f);
        towards[k] = test_random_between(random, -1, 1);
    }
    for (int i = 0; i < BUNDLE; i++)
        rays[i] = bundle_ray(random, kind, apex, towards);
}

/* Hits are equal to the bit; of a miss only the geometry counts. */
static bool same(const kdr_ray_hit *a, const kdr_ray_hit *b) {
    return memcmp(&a->ray, &b->ray, sizeof a->ray) == 0 && a->hit.geometry == b->hit.geometry &&
           (a->hit.geometry == KDR_INVALID_ID || memcmp(&a->hit, &b->hit, sizeof a->hit) == 0);
}

#define PACKET_ANSWERS(N)                                                                                              \
    static size_t differences_of_##N(const kdr_scene *scene, const kdr_ray *rays, const kdr_ray_hit *expected,         \
                                     uint32_t mask) {                                                                  \
        size_t wrong = 0;                                                                                              \
        for (uint32_t first = 0; first < BUNDLE; first += (N)) {                                                       \
            int32_t valid[N];                                                                                          \
            kdr_ray_hit##N packet;                                                                                     \
            kdr_ray##N shadow;                                                                                         \
            uint32_t *field = (uint32_t *)&packet, before[sizeof packet / 4];                                          \
            memset(&packet, 0x5a, sizeof packet);                                                                      \
            for (uint32_t i = 0; i < (N); i++) {                                                                       \
                valid[i] = mask >> i & 1 ? -1 : 0;                                                                     \
                for (uint32_t k = 0; k < 12; k++)                                                                      \
                    memcpy(&field[k * (N) + i], (const uint32_t *)&rays[first + i] + k, 4);                            \
            }                                                                                                          \
            shadow = packet.ray;                                                                                       \
            memcpy(before, &packet, sizeof packet);                                                                    \
            kdr_intersect##N(scene, valid, &packet);                                                                   \
            kdr_occluded##N(scene, valid, &shadow);                                                                    \
            for (uint32_t i = 0; i < (N); i++) {                                                                       \
                kdr_ray_hit given;                                                                                     \
                bool untouched = true;                                                                                 \
                for (uint32_t k = 0; k < 20; k++) {                                                                    \
                    memcpy((uint32_t *)&given + k, &field[k * (N) + i], 4);                                            \
                    untouched &= field[k * (N) + i] == before[k * (N) + i];                                            \
                }                                                                                                      \
                bool hit = expected[first + i].hit.geometry != KDR_INVALID_ID;                                         \
                float tmax = valid[i] && hit ? -INFINITY : rays[first + i].tmax;                                       \
                wrong += shadow.tmax[i] != tmax;                                                                       \
                wrong += valid[i] ? !same(&given, &expected[first + i]) : !untouched;                                  \
            }                                                                                                          \
        }                                                                                                              \
        return wrong;                                                                                                  \
    }

PACKET_ANSWERS(4)
PACKET_ANSWERS(8)
PACKET_ANSWERS(16)

static size_t differences_of_calls(const kdr_scene *scene, const kdr_ray *rays, const kdr_ray_hit *expected,
                                   size_t count) {
    kdr_ray_hit given[BUNDLE];
    uint8_t occluded[BUNDLE];
    size_t wrong = 0;
    for (int coherence = 0; coherence < 3; coherence++) {
        kdr_trace_def def = kdr_default_trace_def();
        def.coherence = (kdr_coherence)coherence;
        for (size_t i = 0; i < count; i++)
            given[i].ray = rays[i];
        kdr_intersect_n(scene, &def, given, count);
        kdr_occluded_n(scene, &def, rays, occluded, count);
        for (size_t i = 0; i < count; i++)
            wrong += !same(&given[i], &expected[i]) + (occluded[i] != (expected[i].hit.geometry != KDR_INVALID_ID));
    }
    return wrong;
}

/* Overlapping triangles of all sizes; some lie in a plane and share edges. */
static float *make_triangles(test_random *random) {
    float *corners = test_allocate((size_t)TRIANGLES * 9, sizeof *corners);
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        float size = i % 50 == 0 ? 1 : 0.05f, centre[3];
        for (int k = 0; k < 3; k++)
            centre[k] =
                i % 3 == 0 ? (float)((int)test_random_below(random, 17) - 8) / 8 : test_random_between(random, -1, 1);
        for (uint32_t k = 0; k < 9; k++)
            corners[9 * i + k] = centre[k % 3] + (i % 3 == 0 ? (k == 3 || k == 7 ? 0.125f : 0)
                                                             : test_random_between(random, -size, size));
    }
    return corners;
}

static void packets_give_the_bits_of_lone_rays_on_every_instruction_set(void **state) {
    (void)state;
    test_random random = test_random_start(test_random_seed(), 4864);
    float *corners = make_triangles(&random);
    kdr_triangles_def def = kdr_default_triangles_def();
    def.vertices = corners;
    def.vertex_count = (size_t)TRIANGLES * 3;
    def.triangle_count = TRIANGLES;
    kdr_device *plain = device_of_isa(KDR_ISA_SCALAR, 1, NULL);
    kdr_scene *reference = committed_scene(plain, &def, 1, NULL);
    size_t sets = 0, hits = 0;
    for (int isa = KDR_ISA_SCALAR; isa <= KDR_ISA_NEON; isa++) {
        kdr_device *device = device_of_isa((kdr_isa)isa, 1, NULL);
        if (!device)
            continue;
        sets++;
        kdr_scene *scene = committed_scene(device, &def, 1, NULL);
        for (int kind = 0; kind < BUNDLE_KINDS; kind++) {
            for (uint32_t bundle = 0; bundle < BUNDLES; bundle++) {
                kdr_ray rays[BUNDLE];
                kdr_ray_hit expected[BUNDLE];
                make_bundle(&random, (bundle_kind)kind, rays);
                for (int i = 0; i < BUNDLE; i++) {
                    expected[i].ray = rays[i];
                    kdr_intersect1(reference, &expected[i]);
                    hits += expected[i].hit.geometry != KDR_INVALID_ID;
                }
                uint32_t mask = bundle % 3 == 0 ? UINT32_MAX : test_random_u32(&random);
                size_t count = bundle % 2 ? BUNDLE : 16 + test_random_below(&random, BUNDLE - 16);
                size_t wrong =
                    differences_of_4(scene, rays, expected, mask) + differences_of_8(scene, rays, expected, mask) +
                    differences_of_16(scene, rays, expected, mask) + differences_of_calls(scene, rays, expected, count);
                if (wrong > 0)
                    printf("%s: kind %d, bundle %u, mask %x: %zu wrong\n", kdr_isa_name((kdr_isa)isa), kind, bundle,
                           mask, wrong);
                assert_int_equal(wrong, 0);
            }
        }
        kdr_scene_destroy(scene);
        kdr_device_destroy(device);
    }
    assert_true(sets >= 1);
    assert_true(hits > (size_t)BUNDLES * BUNDLE * sets);
    kdr_scene_destroy(reference);
    kdr_device_destroy(plain);
    free(corners);
}

static void a_packet_without_active_rays_or_without_a_scene_to_hit_changes_nothing_else(void **state) {
    (void)state;
    kdr_device *device = NULL;
    kdr_scene *scene = NULL;
    assert_int_equal(kdr_device_create(NULL, &device), KDR_OK);
    assert_int_equal(kdr_scene_create(device, &scene), KDR_OK);
    kdr_ray_hit8 packet, before;
    const int32_t none[8] = {0}, one[8] = {0, 0, 0, 1};
    memset(&packet, 0x5a, sizeof packet);
    before = packet;
    kdr_intersect8(scene, none, &packet);
    kdr_occluded8(scene, none, &packet.ray);
    assert_memory_equal(&packet, &before, sizeof packet);

    /* Not committed: the active ray misses, and only that is said. */
    kdr_intersect8(scene, one, &packet);
    before.hit.geometry[3] = KDR_INVALID_ID;
    assert_memory_equal(&packet, &before, sizeof packet);
    kdr_scene_destroy(scene);
    kdr_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packets_give_the_bits_of_lone_rays_on_every_instruction_set),
        cmocka_unit_test(a_packet_without_active_rays_or_without_a_scene_to_hit_changes_nothing_else),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
