/* Dividing a scene into regions.
 *
 * Planes come first, from counters alone. Then each reference goes down through them and is handed, clipped, to every
 * region that it reaches into, however many: one pass counts, one writes, both by all workers. Ranges of references and
 * regions have fixed places, so the outcome does not depend on who did what.
 *
 * Sources: "Parallel KD Tree Acceleration Structures for Ray Tracing on Multi-Core Processor", thesis, 2009, sections
 * 5.2 to 5.7; M. Shevtsov, A. Soupikov, A. Kapustin, "Highly Parallel Fast KD-tree Construction for Interactive Ray
 * Tracing of Dynamic Scenes", 2007, section 4.1.
 * Cost: two passes over the references, each with log2(regions) steps a reference. */
#include "build/regions.h"

#include "build/opening.h"
#include "build/splitter.h"

#define ASSIGN_GRAIN 32768

uint32_t kdr_regions_add_region(kdr_regions *regions, uint32_t wanted) {
    regions->wanted[regions->region_count] = wanted;
    return KDR_REGION | regions->region_count++;
}

typedef struct assigning {
    const kdr_references *from;
    const kdr_regions *regions;
    uint32_t *places;   /* range x region: counts, then places */
    kdr_references *to; /* a region; NULL: count only */
    kdr_box *boxes;     /* worker x region */
} assigning;

/* Hands a reference, as far as it lies in a part of the scene, to the regions below a plane. */
static void assign(const assigning *a, uint32_t at, kdr_box box, uint32_t primitive, uint32_t *places, kdr_box *boxes) {
    while (!(at & KDR_REGION)) {
        const kdr_region_plane *p = &a->regions->planes[at];
        bool right = box.hi[p->axis] > p->plane, left = box.lo[p->axis] < p->plane || !right;
        if (left && right) {
            kdr_box part = box;
            part.hi[p->axis] = p->plane;
            assign(a, p->child[0], part, primitive, places, boxes);
            box.lo[p->axis] = p->plane;
        }
        at = p->child[right];
    }
    uint32_t region = at & ~KDR_REGION, place = places[region]++;
    if (!a->to)
        return;
    const kdr_references *to = &a->to[region];
    for (int k = 0; k < 3; k++) {
        to->lo[k][place] = box.lo[k];
        to->hi[k][place] = box.hi[k];
    }
    to->primitive[place] = primitive;
    kdr_box_add(&boxes[region], &box);
}

static void assign_range(void *context, size_t begin, size_t end, uint32_t worker) {
    const assigning *a = context;
    const kdr_references *from = a->from;
    uint32_t *places = a->places + begin / ASSIGN_GRAIN * a->regions->region_count;
    kdr_box *boxes = a->to ? a->boxes + (size_t)worker * a->regions->region_count : NULL;
    for (size_t i = begin; i < end; i++) {
        kdr_box box;
        for (int k = 0; k < 3; k++) {
            box.lo[k] = from->lo[k][i];
            box.hi[k] = from->hi[k][i];
        }
        assign(a, a->regions->plane_count > 0 ? 0 : KDR_REGION, box, from->primitive[i], places, boxes);
    }
}

/* Counts the references of every region; returns their sum. Counts a range are left as places. */
static uint64_t count_references(kdr_build_state *state, assigning *a, uint32_t *counts) {
    uint32_t regions = a->regions->region_count, ranges = a->from->count / ASSIGN_GRAIN + 1;
    memset(a->places, 0, (size_t)ranges * regions * sizeof *a->places);
    a->to = NULL;
    kdr_parallel_for(state->crew, a->from->count, ASSIGN_GRAIN, assign_range, a);
    uint64_t sum = 0;
    for (uint32_t r = 0; r < regions; r++) {
        counts[r] = 0;
        for (uint32_t i = 0; i < ranges; i++) {
            uint32_t *place = &a->places[(size_t)i * regions + r], count = *place;
            *place = counts[r];
            counts[r] += count;
        }
        sum += counts[r];
    }
    return sum;
}

/* Writes the nodes above the regions and gives each region its place in the tree. */
static bool grow_planes(kdr_build_state *state, const kdr_regions *regions, uint32_t at, const kdr_build_task *task,
                        kdr_build_task *tasks) {
    if (at & KDR_REGION) {
        kdr_build_task *to = &tasks[at & ~KDR_REGION];
        to->cell = task->cell;
        to->node = task->node;
        to->depth = task->depth;
        return true;
    }
    const kdr_region_plane *p = &regions->planes[at];
    uint32_t pair;
    if (!kdr_grow_interior(state, &state->shop->workers[0], task->node, p->axis, p->plane, &pair))
        return false;
    for (uint32_t side = 0; side < 2; side++) {
        kdr_build_task child = {.cell = task->cell, .node = 2 * pair + side, .depth = task->depth + 1};
        *(side == 0 ? &child.cell.hi[p->axis] : &child.cell.lo[p->axis]) = p->plane;
        if (!grow_planes(state, regions, p->child[side], &child, tasks))
            return false;
    }
    return true;
}

/* Writes the references of all regions into memory of their own. Returns false, and nothing is held, when there is
 * none. */
static bool write_references(kdr_build_state *state, assigning *a, const uint32_t *counts, kdr_build_task *tasks) {
    kdr_workshop *shop = state->shop;
    kdr_arena *arena = &shop->workers[0].arena;
    uint32_t regions = a->regions->region_count, workers = shop->worker_count;
    a->to = kdr_arena_get(arena, regions * sizeof *a->to);
    a->boxes = kdr_arena_get(arena, (size_t)workers * regions * sizeof *a->boxes);
    bool memory = a->to && a->boxes;
    for (uint32_t r = 0; r < regions && memory; r++) {
        tasks[r].memory_size = kdr_references_bytes(counts[r] > 0 ? counts[r] : 1);
        tasks[r].memory = kdr_bulk_get(shop->bulk, &tasks[r].memory_size);
        memory = tasks[r].memory != NULL;
        if (memory)
            tasks[r].references = a->to[r] = kdr_references_in(tasks[r].memory, counts[r]);
    }
    if (!memory) {
        for (uint32_t r = 0; r < regions; r++)
            kdr_bulk_put(shop->bulk, tasks[r].memory, tasks[r].memory_size);
        return false;
    }
    for (size_t i = 0; i < (size_t)workers * regions; i++)
        a->boxes[i] = kdr_box_empty();
    kdr_parallel_for(state->crew, a->from->count, ASSIGN_GRAIN, assign_range, a);
    for (uint32_t r = 0; r < regions; r++) {
        tasks[r].box = a->boxes[r];
        for (uint32_t w = 1; w < workers; w++)
            kdr_box_add(&tasks[r].box, &a->boxes[(size_t)w * regions + r]);
    }
    return true;
}

static uint32_t make_tasks(kdr_build_state *state, const kdr_build_task *root, uint32_t count, kdr_build_task *tasks,
                           kdr_regions_fn *find, const void *context, kdr_regions *regions) {
    kdr_arena *arena = &state->shop->workers[0].arena;
    uint32_t ranges = root->references.count / ASSIGN_GRAIN + 1, *counts;
    assigning a = {.from = &root->references, .regions = regions};
    counts = kdr_arena_get(arena, KDR_MAX_REGIONS * sizeof *counts);
    a.places = kdr_arena_get(arena, (size_t)ranges * count * sizeof *a.places);
    if (!counts || !a.places) {
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
        return 0;
    }

    /* Fewer regions, where they would take more than half of the references that splitting may add: the subtrees need
     * the other half. */
    uint64_t sum, whole = root->references.count;
    for (;; count = (count + 1) / 2) {
        regions->plane_count = regions->region_count = 0;
        find(context, count, regions);
        sum = count_references(state, &a, counts);
        if (2 * (sum - whole) <= root->budget - whole || count == 1)
            break;
    }
    memset(tasks, 0, regions->region_count * sizeof *tasks);
    if (!write_references(state, &a, counts, tasks)) {
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
        return 0;
    }
    uint64_t left = root->budget, references = sum;
    for (uint32_t r = 0; r < regions->region_count; r++) {
        tasks[r].budget = references > 0 ? (uint64_t)((unsigned __int128)left * counts[r] / references) : 0;
        left -= tasks[r].budget;
        references -= counts[r];
    }
    grow_planes(state, regions, regions->plane_count > 0 ? 0 : KDR_REGION, root, tasks);
    return regions->region_count;
}

uint32_t kdr_regions_divide(kdr_build_state *state, kdr_build_task *root, uint32_t count, kdr_build_task *tasks,
                            kdr_regions_fn *find, const void *context) {
    kdr_arena *arena = &state->shop->workers[0].arena;
    kdr_arena_mark mark = kdr_arena_save(arena);
    kdr_regions *regions = kdr_arena_get(arena, sizeof *regions);
    uint32_t made = 0;
    if (regions)
        made = make_tasks(state, root, count, tasks, find, context, regions);
    else
        kdr_build_fail(state, KDR_ERROR_OUT_OF_MEMORY);
    kdr_bulk_put(state->shop->bulk, root->memory, root->memory_size);
    if (!kdr_build_failed(state))
        made = kdr_regions_cut(state, true, tasks, made, regions->wanted);
    kdr_arena_restore(arena, mark);
    return made;
}

/* Cuts one task; false if no plane separates it, or there is no memory. */
static bool cut(kdr_build_state *state, bool parallel, const kdr_build_task *task, uint32_t wanted,
                kdr_build_task children[2]) {
    kdr_opening o;
    uint32_t count = task->references.count, sets[3];
    if (count < 2 || task->depth >= state->plan.depth_limit ||
        !kdr_opening_begin(&o, state, &state->shop->workers[0], parallel, task))
        return false;
    o.owned = true;
    bool done = false;
    kdr_single_axes(KDR_AXIS_LONGEST, &task->cell, task->depth, sets);
    for (int i = 0; i < 3 && !done; i++) {
        uint32_t axis = (uint32_t)__builtin_ctz(sets[i]);
        uint64_t rank = (uint64_t)count * 2 * ((wanted + 1) / 2) / wanted, left, right;
        kdr_split split = {.axis = axis, .flat_left = true};
        split.plane = kdr_rank_select(&o, axis, KDR_RANK_ENDS, rank, NULL);
        if (!(split.plane > task->cell.lo[axis] && split.plane < task->cell.hi[axis]))
            continue;
        kdr_opening_count(&o, &split, &left, &right);
        if (left == count || right == count || left + right > task->budget)
            continue;
        if (!kdr_opening_divide(&o, &split, left, right, false, children))
            break;
        done = true;
    }
    kdr_opening_end(&o);
    return done;
}

uint32_t kdr_regions_cut(kdr_build_state *state, bool parallel, kdr_build_task *tasks, uint32_t count,
                         uint32_t *wanted) {
    for (uint32_t i = 0; i < count;) {
        kdr_build_task children[2];
        if (wanted[i] < 2 || kdr_build_failed(state) || !cut(state, parallel, &tasks[i], wanted[i], children)) {
            i++;
            continue;
        }
        kdr_bulk_put(state->shop->bulk, tasks[i].memory, tasks[i].memory_size);
        tasks[i] = children[0];
        tasks[count] = children[1];
        wanted[count++] = wanted[i] / 2;
        wanted[i] -= wanted[i] / 2;
    }
    return count;
}
