/* One run over a scene: every tracer gets the same rays, taking turns.
 *
 * A round rebuilds each engine and sends all kinds of rays through each tracer, so that whatever slows the machine for
 * a while slows all of them; every other round goes backwards, so that none always follows the same neighbour. A figure
 * is the median over the rounds. Only calls of a tracer are timed: laying out rays and counting hits are not.
 *
 * Of what moves, a round does so for every frame, with the rays of that frame; a figure is then the mean over the
 * frames of their medians, and speeds are those of all frames' rays together. */
#include "bench.h"
#include "memory.h"

#include <string.h>

#define ENGINE_LIMIT (KDR_BENCH_ROW_LIMIT / KDR_BENCH_ENGINE_TRACERS)

typedef struct measuring {
    kdr_bench_scene *scene;
    const kdr_bench_options *options;
    uint32_t frames, kinds;                 /* at least 1 frame; the first so many kinds of rays */
    kdr_bench_engine engines[ENGINE_LIMIT]; /* kdray's is the first */
    uint32_t engine_count;
    bool timed[ENGINE_LIMIT]; /* some tracer of the engine is asked for */
    uint32_t row_engine[KDR_BENCH_ROW_LIMIT];
    const kdr_bench_tracer *row_tracer[KDR_BENCH_ROW_LIMIT];
    kdr_bench_row *rows;
    uint32_t row_count;
    kdr_bench_workload workload;
    kdr_bench_sheet sheet;
    size_t sheet_room;     /* rays */
    size_t *ray_counts;    /* [frame][kind] */
    double *build_seconds; /* [engine][frame][round] */
    double *trace_seconds; /* [row][kind][frame][round] */
    const kdr_logger *logger;
    kdr_progress *progress;
    uint64_t finished, total;
} measuring;

static void finish_step(measuring *m) { kdr_progress_update(m->progress, m->scene->name, ++m->finished, m->total); }

/* ---- names */

static const struct engine_names {
    const char *engine;
    const char *tracers[KDR_BENCH_ENGINE_TRACERS];
} names[ENGINE_LIMIT] = {
    {"kdray", {"stream", "packet", "single"}},
    {"embree/low", {"packet", "single"}},
    {"embree/medium", {"packet", "single"}},
    {"embree/high", {"packet", "single"}},
};

static void join_names(const char *engine, const char *tracer, char out[KDR_BENCH_NAME_SIZE]) {
    snprintf(out, KDR_BENCH_NAME_SIZE, "%s/%s", engine, tracer);
}

static bool begins(const char *name, const char *beginning) { return strncmp(name, beginning, strlen(beginning)) == 0; }

static bool asked_for(const kdr_bench_options *options, const char *tracer) {
    for (uint32_t i = 0; i < options->only_count; i++)
        if (begins(tracer, options->only[i]))
            return true;
    return options->only_count == 0;
}

bool kdr_bench_wanted(const kdr_bench_options *options, const char *beginning) {
    for (uint32_t i = 0; i < ENGINE_LIMIT; i++) {
        for (uint32_t k = 0; k < KDR_BENCH_ENGINE_TRACERS && names[i].tracers[k]; k++) {
            char name[KDR_BENCH_NAME_SIZE];
            join_names(names[i].engine, names[i].tracers[k], name);
            if (begins(name, beginning) && asked_for(options, name))
                return true;
        }
    }
    return false;
}

bool kdr_bench_known(const char *beginning) { return kdr_bench_wanted(&(kdr_bench_options){0}, beginning); }

/* ---- engines and rows */

/* Takes in the engine just opened: builds it for the first time and makes a row for each of its tracers asked for. */
static bool take_engine(measuring *m) {
    uint32_t number = m->engine_count++;
    kdr_bench_engine *engine = &m->engines[number];
    double begin = kdr_seconds();
    if (!engine->build(engine))
        return false;
    double cold = kdr_seconds() - begin;
    double triangles = (double)m->scene->mesh->triangle_count;
    for (uint32_t i = 0; i < KDR_BENCH_ENGINE_TRACERS && engine->tracers[i].name; i++) {
        char name[KDR_BENCH_NAME_SIZE];
        join_names(engine->name, engine->tracers[i].name, name);
        if (!asked_for(m->options, name))
            continue;
        m->timed[number] = true;
        m->row_engine[m->row_count] = number;
        m->row_tracer[m->row_count] = &engine->tracers[i];
        kdr_bench_row *row = &m->rows[m->row_count++];
        *row = (kdr_bench_row){.threads = kdr_device_worker_count(m->scene->device),
                               .triangles = m->scene->mesh->triangle_count,
                               .build_cold_ms = cold * 1e3,
                               .bytes_per_triangle = engine->bytes(engine) / triangles};
        memcpy(row->scene, m->scene->name, sizeof row->scene);
        memcpy(row->tracer, name, sizeof row->tracer);
    }
    finish_step(m);
    return true;
}

static bool open_engines(measuring *m, bool with_embree, const kdr_logger *logger) {
    /* kdray is always there: its hits say where the secondary rays begin */
    if (!kdr_bench_kdray_open(m->scene, &m->options->build, logger, &m->engines[0]) || !take_engine(m) ||
        !kdr_bench_workload_make(m->scene, kdr_bench_kdray_scene(&m->engines[0]), logger, &m->workload))
        return false;

    for (uint32_t i = 1; with_embree && i < ENGINE_LIMIT; i++) {
        if (!kdr_bench_wanted(m->options, names[i].engine))
            continue;
        kdr_bench_engine *engine = &m->engines[m->engine_count];
        if (!kdr_bench_embree_open(m->scene, names[i].engine, logger, engine) || !take_engine(m))
            return false;
    }
    return true;
}

/* ---- one step: build, or trace one kind of rays */

/* Where the seconds of a round and a frame are, of series `number`. */
static size_t place(const measuring *m, size_t number, uint32_t frame, uint32_t round) {
    return (number * m->frames + frame) * m->options->rounds + round;
}

static bool time_build(measuring *m, uint32_t number, uint32_t frame, uint32_t round) {
    bool wanted = m->timed[number] || (number == 0 && m->scene->animation); /* kdray's says where rays begin */
    if (!wanted)
        return true;
    kdr_bench_engine *engine = &m->engines[number];
    double begin = kdr_seconds();
    if (!engine->build(engine))
        return false;
    m->build_seconds[place(m, number, frame, round)] = kdr_seconds() - begin;
    finish_step(m);
    return true;
}

typedef struct trace_call {
    const kdr_bench_engine *engine;
    const kdr_bench_tracer *tracer;
    const kdr_bench_rays *rays;
    kdr_bench_sheet *sheet;
} trace_call;

static void fill_block(void *context, size_t begin, size_t end) {
    const trace_call *call = context;
    call->tracer->fill(call->engine, call->rays, begin, end, call->sheet);
}

static void trace_block(void *context, size_t begin, size_t end) {
    const trace_call *call = context;
    call->tracer->trace(call->engine, call->rays, begin, end, call->sheet);
}

static void time_trace(measuring *m, uint32_t row, kdr_bench_kind kind, uint32_t frame, uint32_t round) {
    trace_call call = {&m->engines[m->row_engine[row]], m->row_tracer[row], &m->workload.kinds[kind], &m->sheet};
    size_t count = call.rays->count;
    kdr_bench_run(m->scene, count, fill_block, &call);
    double begin = kdr_seconds();
    kdr_bench_run(m->scene, count, trace_block, &call);
    m->trace_seconds[place(m, row * KDR_BENCH_KINDS + kind, frame, round)] = kdr_seconds() - begin;
    m->ray_counts[frame * KDR_BENCH_KINDS + kind] = count;
    if (round == 0)
        m->rows[row].hits[kind] += call.tracer->count(call.engine, call.rays, 0, count, call.sheet);
    finish_step(m);
}

/* The i-th of `count` in the order of a round. */
static uint32_t turn(uint32_t i, uint32_t count, uint32_t round) { return round % 2 ? count - 1 - i : i; }

/* Room for the rays of all kinds in a tracer's layout; what was there is lost when it grows. */
static void make_sheet(measuring *m) {
    size_t longest = 0;
    for (uint32_t kind = 0; kind < m->kinds; kind++)
        longest = m->workload.kinds[kind].count > longest ? m->workload.kinds[kind].count : longest;
    size_t room = (longest / KDR_BENCH_BLOCK + 1) * KDR_BENCH_BLOCK;
    if (room <= m->sheet_room)
        return;
    kdr_memory_release(m->sheet.rays);
    kdr_memory_release(m->sheet.occluded);
    m->sheet.rays = kdr_memory_get(room, KDR_BENCH_SHEET_BYTES);
    m->sheet.occluded = kdr_memory_get(room, 1);
    m->sheet_room = room;
}

/* Puts the mesh of a frame in the place of the one before, for every engine. */
static bool show_frame(measuring *m, uint32_t frame) {
    if (!m->scene->animation)
        return true;
    if (kdr_animation_sample(m->scene->animation, frame * m->scene->frame_seconds, m->logger, &m->scene->mesh) !=
        KDR_OK)
        return false;
    for (uint32_t i = 0; i < m->engine_count; i++)
        if (!m->engines[i].show(&m->engines[i], m->scene->mesh))
            return false;
    return true;
}

static bool run_frame(measuring *m, uint32_t frame, uint32_t round) {
    if (!show_frame(m, frame))
        return false;
    for (uint32_t i = 0; i < m->engine_count; i++)
        if (!time_build(m, turn(i, m->engine_count, round + frame), frame, round))
            return false;
    if (m->scene->animation) {
        kdr_bench_workload_release(&m->workload);
        if (!kdr_bench_workload_make(m->scene, kdr_bench_kdray_scene(&m->engines[0]), m->logger, &m->workload))
            return false;
        make_sheet(m);
    }
    for (uint32_t kind = 0; kind < m->kinds; kind++)
        for (uint32_t i = 0; i < m->row_count; i++)
            time_trace(m, turn(i, m->row_count, round + frame), (kdr_bench_kind)kind, frame, round);
    return true;
}

/* ---- the whole */

static void make_room(measuring *m) {
    size_t samples = (size_t)m->frames * m->options->rounds;
    make_sheet(m);
    m->ray_counts = kdr_memory_get(m->frames, KDR_BENCH_KINDS * sizeof(size_t));
    m->build_seconds = kdr_memory_get(samples, ENGINE_LIMIT * sizeof(double));
    m->trace_seconds = kdr_memory_get(samples, KDR_BENCH_ROW_LIMIT * KDR_BENCH_KINDS * sizeof(double));
}

/* The sum over the frames of the medians over the rounds, of series `number`. */
static double sum_of(const measuring *m, double *seconds, size_t number) {
    double sum = 0;
    for (uint32_t frame = 0; frame < m->frames; frame++)
        sum += kdr_bench_median(seconds + place(m, number, frame, 0), m->options->rounds);
    return sum;
}

static void take_medians(measuring *m) {
    double build[ENGINE_LIMIT] = {0};
    for (uint32_t i = 0; i < m->engine_count; i++)
        if (m->timed[i])
            build[i] = sum_of(m, m->build_seconds, i);
    for (uint32_t i = 0; i < m->row_count; i++) {
        kdr_bench_row *row = &m->rows[i];
        double trace[KDR_BENCH_KINDS] = {0};
        for (uint32_t kind = 0; kind < m->kinds; kind++) {
            size_t count = 0;
            for (uint32_t frame = 0; frame < m->frames; frame++)
                count += m->ray_counts[frame * KDR_BENCH_KINDS + kind];
            trace[kind] = sum_of(m, m->trace_seconds, i * KDR_BENCH_KINDS + kind);
            row->speed[kind] = count > 0 ? (double)count / trace[kind] * 1e-6 : 0;
        }
        row->build_ms = build[m->row_engine[i]] / m->frames * 1e3;
        row->image_ms = row->build_ms + (trace[KDR_BENCH_PRIMARY] + trace[KDR_BENCH_SHADOW]) / m->frames * 1e3;
    }
}

bool kdr_bench_measure(kdr_bench_scene *scene, const kdr_bench_options *options, bool with_embree,
                       const kdr_logger *logger, kdr_progress *progress, kdr_bench_row rows[KDR_BENCH_ROW_LIMIT],
                       uint32_t *row_count) {
    measuring *m = kdr_memory_get(1, sizeof *m);
    *m = (measuring){.scene = scene,
                     .options = options,
                     .frames = scene->animation ? options->frames : 1,
                     .kinds = scene->animation ? KDR_BENCH_AO : KDR_BENCH_KINDS,
                     .rows = rows,
                     .logger = logger,
                     .progress = progress};
    kdr_progress_step(progress, "building");
    bool good = open_engines(m, with_embree, logger);
    if (good) {
        make_room(m);
        uint32_t timed = 0;
        for (uint32_t i = 0; i < m->engine_count; i++)
            timed += m->timed[i];
        timed += scene->animation && !m->timed[0];
        m->total = m->finished + (uint64_t)options->rounds * m->frames * (timed + m->row_count * m->kinds);
        for (uint32_t round = 0; good && round < options->rounds; round++)
            for (uint32_t frame = 0; good && frame < m->frames; frame++)
                good = run_frame(m, frame, round);
        if (good)
            take_medians(m);
    }
    *row_count = good ? m->row_count : 0;

    for (uint32_t i = 0; i < m->engine_count; i++)
        m->engines[i].close(&m->engines[i]);
    kdr_bench_workload_release(&m->workload);
    kdr_memory_release(m->sheet.rays);
    kdr_memory_release(m->sheet.occluded);
    kdr_memory_release(m->ray_counts);
    kdr_memory_release(m->build_seconds);
    kdr_memory_release(m->trace_seconds);
    kdr_memory_release(m);
    return good;
}
