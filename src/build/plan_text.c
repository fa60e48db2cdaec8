/* The plan of a build as text: one table of keys, which prints, parses and explains itself. */
#include "build/plan.h"

#include "tree/tree.h"

#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WORD_SIZE 48    /* bytes of the longest number that is read, with its end */
#define CLUSTER_COUNT 8 /* regions where none are said */

/* One of a few words: its number is the value. An empty name has no word. */
typedef struct key_choice {
    const char *const *names;
    int count;
} key_choice;

static const char *const quality_names[] = {"fast", "balanced", "best", "lazy"};
static const char *const split_names[] = {"binned", "space", "object", "sweep"};
static const char *const axis_names[] = {"", "best", "longest", "robin"};
static const char *const order_names[] = {"dfs", "bfs"};
static const char *const share_names[] = {"none", "serial", "line", "grid", "cluster"};
static const char *const event_names[] = {"", "", "2", "3"};
static const char *const straddle_names[] = {"auto", "general", "clip"};
static const char *const trace_names[] = {"auto", "stack", "restart", "push-down", "short-stack", "backtrack"};
static const char *const nodes_names[] = {"structures", "arrays"};
static const char *const mailbox_names[] = {"0", "8", "16", "32", "64"};
static const char *const test_names[] = {"watertight", "moller-trumbore", "projection"};
static const char *const bool_names[] = {"no", "yes"};

/* How a key's value is held in a def: as a word of a list, a whole number or a real one. */
typedef enum key_kind { KEY_QUALITY, KEY_CHOICE, KEY_SHARE, KEY_WHOLE, KEY_REAL, KEY_BOOL } key_kind;

typedef struct plan_key {
    const char *name, *allowed; /* allowed: as it follows "expected" */
    const char *text;
    size_t offset; /* in kdr_build_def */
    key_kind kind;
    key_choice choice;
    double min, max;
    bool above_min; /* min itself is not allowed */
    bool or_zero;   /* 0 is allowed beside what is from min to max */
} plan_key;

static const plan_key keys[] = {
    {.name = "quality",
     .allowed = "fast, balanced, best or lazy",
     .text = "fast|balanced|best|lazy, default balanced: every other key as it suits a tree that serves one picture, a "
             "few, many, or few rays of a large scene; it counts before all others",
     .kind = KEY_QUALITY,
     .choice = {quality_names, 4}},
    {.name = "split",
     .allowed = "binned, space, object or sweep",
     .text = "binned|space|object|sweep, default binned: where the surface area heuristic says, by bins; the middle of "
             "the cell; the median of the primitives; the heuristic exactly, by sorted events",
     .offset = offsetof(kdr_build_def, split),
     .kind = KEY_CHOICE,
     .choice = {split_names, 4}},
    {.name = "axis",
     .allowed = "best, longest or robin",
     .text = "best|longest|robin, default best for binned and sweep, longest for space and object: the axis that costs "
             "least, "
             "the longest of the cell, or each in turn",
     .offset = offsetof(kdr_build_def, axis),
     .kind = KEY_CHOICE,
     .choice = {axis_names, 4}},
    {.name = "order",
     .allowed = "dfs or bfs",
     .text = "dfs|bfs, default dfs: open nodes depth first or breadth first; the tree is the same",
     .offset = offsetof(kdr_build_def, order),
     .kind = KEY_CHOICE,
     .choice = {order_names, 2}},
    {.name = "share",
     .allowed = "none, serial/N, line/N, grid/N or cluster/N with N from 1 to 1024",
     .text = "none|serial/N|line/N|grid/N|cluster[/N], default none, cluster is cluster/8: divide the scene into N "
             "regions first, by one worker, in slices, in boxes, or in slices that are then handed around",
     .offset = offsetof(kdr_build_def, share),
     .kind = KEY_SHARE,
     .choice = {share_names, 5},
     .min = 1,
     .max = KDR_MAX_SHARE_COUNT},
    {.name = "events",
     .allowed = "2 or 3",
     .text = "2|3, default 2: events of the sweep: begin and end, or lying in a plane as well",
     .offset = offsetof(kdr_build_def, events),
     .kind = KEY_CHOICE,
     .choice = {event_names, 4}},
    {.name = "straddle",
     .allowed = "auto, general or clip",
     .text = "auto|general|clip, default auto: where triangles are on both sides of a plane, cut their boxes, or the "
             "triangles, or these where boxes are mostly empty",
     .offset = offsetof(kdr_build_def, straddle),
     .kind = KEY_CHOICE,
     .choice = {straddle_names, 3}},
    {.name = "retract",
     .allowed = "no or yes",
     .text = "no|yes, default no: take back splits that did not pay, once the tree is built",
     .offset = offsetof(kdr_build_def, retract),
     .kind = KEY_BOOL,
     .choice = {bool_names, 2}},
    {.name = "box-weight",
     .allowed = "a number from 0 to 1",
     .text =
         "0 to 1, default 0: how much of a plane's cost goes by the bounds of what lies beside it instead of by the "
         "parts of the cell; for sweep",
     .offset = offsetof(kdr_build_def, box_weight),
     .kind = KEY_REAL,
     .max = 1},
    {.name = "empty-bonus",
     .allowed = "a number above 0 and at most 1",
     .text =
         "above 0 to 1, default 0.8 for sweep, 1 for the others: factor of the cost of triangles where a plane cuts "
         "off empty space",
     .offset = offsetof(kdr_build_def, empty_bonus),
     .kind = KEY_REAL,
     .max = 1,
     .above_min = true},
    {.name = "traversal-cost",
     .allowed = "a number above 0 and at most 1e+06",
     .text = "above 0 to 1e+06, default 16: cost of a step through an interior node",
     .offset = offsetof(kdr_build_def, cost_traversal),
     .kind = KEY_REAL,
     .max = KDR_PLAN_COST_LIMIT,
     .above_min = true},
    {.name = "intersection-cost",
     .allowed = "a number above 0 and at most 1e+06",
     .text = "above 0 to 1e+06, default 1: cost of a triangle test",
     .offset = offsetof(kdr_build_def, cost_intersection),
     .kind = KEY_REAL,
     .max = KDR_PLAN_COST_LIMIT,
     .above_min = true},
    {.name = "leaf-limit",
     .allowed = "a whole number from 1 to 4294967295",
     .text =
         "1 to 4294967295, default 64 for binned and sweep, 8 for space and object: split every leaf of more triangles",
     .offset = offsetof(kdr_build_def, leaf_limit),
     .kind = KEY_WHOLE,
     .min = 1,
     .max = UINT32_MAX},
    {.name = "depth-limit",
     .allowed = "a whole number from 0 to 60",
     .text = "0 to 60, default 0: deepest leaf; 0 is as deep as the number of triangles asks for",
     .offset = offsetof(kdr_build_def, depth_limit),
     .kind = KEY_WHOLE,
     .max = KDR_MAX_DEPTH},
    {.name = "reference-limit",
     .allowed = "0 or a number from 1 to 1e+06",
     .text = "1 to 1e+06, default 0: most references a triangle; 0 is 4, or 8 where boxes are next to empty",
     .offset = offsetof(kdr_build_def, reference_limit),
     .kind = KEY_REAL,
     .or_zero = true,
     .min = 1,
     .max = KDR_PLAN_COST_LIMIT},
    {.name = "lazy-limit",
     .allowed = "0, or a whole number from 64 to 8192",
     .text =
         "64 to 8192, default 0: leave nodes of at most so many triangles closed until the first ray comes; 0: none",
     .offset = offsetof(kdr_build_def, lazy_limit),
     .kind = KEY_WHOLE,
     .min = KDR_MIN_LAZY_LIMIT,
     .max = KDR_MAX_LAZY_LIMIT,
     .or_zero = true},
    {.name = "trace",
     .allowed = "auto, stack, restart, push-down, short-stack or backtrack",
     .text = "auto|stack|restart|push-down|short-stack|backtrack, default auto: trace rays the fastest way, or each "
             "alone through the kd-tree by the traversal of that name",
     .offset = offsetof(kdr_build_def, trace),
     .kind = KEY_CHOICE,
     .choice = {trace_names, 6}},
    {.name = "nodes",
     .allowed = "structures or arrays",
     .text =
         "structures|arrays, default structures: trace nodes of 8 bytes, or, with trace=stack and restart, an array "
         "for each of their fields",
     .offset = offsetof(kdr_build_def, nodes),
     .kind = KEY_CHOICE,
     .choice = {nodes_names, 2}},
    {.name = "mailbox",
     .allowed = "0, 8, 16, 32 or 64",
     .text = "0|8|16|32|64, default 0: triangles that a ray remembers having met; not with trace=auto",
     .offset = offsetof(kdr_build_def, mailbox),
     .kind = KEY_CHOICE,
     .choice = {mailbox_names, 5}},
    {.name = "test",
     .allowed = "watertight, moller-trumbore or projection",
     .text = "watertight|moller-trumbore|projection, default watertight: test triangles exactly, or, not with "
             "trace=auto, in "
             "floats: from corners, or from precomputed projections",
     .offset = offsetof(kdr_build_def, test),
     .kind = KEY_CHOICE,
     .choice = {test_names, 3}},
};
enum { KEY_COUNT = sizeof keys / sizeof keys[0] };

/* Choices are enums, whole numbers are uint32_t: all are read and written as four bytes. */
_Static_assert(sizeof(kdr_split_rule) == 4 && sizeof(kdr_share_rule) == 4 && sizeof(float) == 4,
               "values of four bytes");
_Static_assert(offsetof(kdr_build_def, share_count) == offsetof(kdr_build_def, share) + 4, "a share and its number");

const char *kdr_build_def_key_name(size_t i) { return i < KEY_COUNT ? keys[i].name : NULL; }

const char *kdr_build_def_key_text(size_t i) { return i < KEY_COUNT ? keys[i].text : NULL; }

/* Numbers are the same in every locale: the calling thread gets the plain one for a while. */
static locale_t enter_plain_locale(locale_t *plain) {
    *plain = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    return *plain ? uselocale(*plain) : (locale_t)0;
}

static void leave_plain_locale(locale_t before, locale_t plain) {
    if (!plain)
        return;
    uselocale(before);
    freelocale(plain);
}

/* ---- text to plan */

typedef struct reading {
    kdr_build_def def;
    kdr_quality quality;
} reading;

static void complain(char *problem, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));

static void complain(char *problem, size_t size, const char *format, ...) {
    if (size == 0)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(problem, size, format, arguments);
    va_end(arguments);
}

static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

static bool read_number(const char *text, size_t length, const char *letters, double *out) {
    char word[WORD_SIZE];
    if (length == 0 || length >= sizeof word || strspn(text, letters) < length)
        return false;
    memcpy(word, text, length);
    word[length] = 0;
    char *stop;
    *out = strtod(word, &stop);
    return *stop == 0;
}

/* The number of a word of a list, or -1. */
static int find_word(const key_choice *choice, const char *text, size_t length) {
    for (int i = 0; i < choice->count; i++)
        if (length > 0 && strlen(choice->names[i]) == length && memcmp(choice->names[i], text, length) == 0)
            return i;
    return -1;
}

static bool read_whole(const plan_key *key, const char *text, size_t length, uint32_t *out) {
    double value;
    if (!read_number(text, length, "0123456789", &value))
        return false;
    if (!(value >= key->min && value <= key->max) && !(key->or_zero && value == 0))
        return false;
    *out = (uint32_t)value;
    return true;
}

/* A word, and a number of regions where it takes one. */
static bool read_share(const plan_key *key, const char *text, size_t length, char *to) {
    const char *slash = memchr(text, '/', length);
    int word = find_word(&key->choice, text, slash ? (size_t)(slash - text) : length);
    uint32_t regions = word == KDR_SHARE_CLUSTER ? CLUSTER_COUNT : 0;
    if (slash && !read_whole(key, slash + 1, length - (size_t)(slash + 1 - text), &regions))
        return false;
    memcpy(to, &word, sizeof word);
    memcpy(to + 4, &regions, sizeof regions);
    return word >= 0 && (word == KDR_SHARE_NONE) == (regions == 0);
}

static bool read_value(const plan_key *key, const char *text, size_t length, reading *out) {
    char *to = (char *)&out->def + key->offset;
    double value;
    int word = find_word(&key->choice, text, length);
    switch (key->kind) {
    case KEY_QUALITY: out->quality = (kdr_quality)word; return word >= 0;
    case KEY_CHOICE: memcpy(to, &word, sizeof word); return word >= 0;
    case KEY_BOOL: *(bool *)to = word > 0; return word >= 0;
    case KEY_SHARE: return read_share(key, text, length, to);
    case KEY_WHOLE: return read_whole(key, text, length, (uint32_t *)(void *)to);
    case KEY_REAL: break;
    }
    if (!read_number(text, length, "0123456789+-.eE", &value))
        return false;
    /* Rounding must not lead out of the range either. */
    float real = value <= key->max ? (float)value : INFINITY;
    memcpy(to, &real, sizeof real);
    if (key->or_zero && real == 0)
        return true;
    return (double)real <= key->max && (key->above_min ? (double)real > key->min : (double)real >= key->min);
}

static const plan_key *find_key(const char *name, size_t length) {
    for (size_t i = 0; i < KEY_COUNT; i++)
        if (strlen(keys[i].name) == length && memcmp(keys[i].name, name, length) == 0)
            return &keys[i];
    return NULL;
}

static void complain_of_key(char *problem, size_t size, const char *word, int length) {
    char names[300] = "";
    size_t used = 0;
    for (size_t i = 0; i < KEY_COUNT; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s",
                                 i == 0 ? "" : (i + 1 < KEY_COUNT ? ", " : " or "), keys[i].name);
    complain(problem, size, "expected KEY=VALUE with one of the keys %s, found \"%.*s\"", names, length, word);
}

static bool parse(const char *text, reading *out, char *problem, size_t size) {
    uint32_t given = 0;
    for (const char *at = text; *at;) {
        if (is_space(*at)) {
            at++;
            continue;
        }
        const char *word = at;
        while (*at && !is_space(*at))
            at++;
        size_t length = (size_t)(at - word);
        int shown = length < 40 ? (int)length : 40;
        const char *equals = memchr(word, '=', length);
        const plan_key *key = equals ? find_key(word, (size_t)(equals - word)) : NULL;
        if (!key) {
            complain_of_key(problem, size, word, shown);
            return false;
        }
        uint32_t bit = 1u << (key - keys);
        if (given & bit) {
            complain(problem, size, "%s: expected it once, found \"%.*s\" as well", key->name, shown, word);
            return false;
        }
        given |= bit;
        const char *value = equals + 1;
        if (!read_value(key, value, (size_t)(at - value), out)) {
            length = (size_t)(at - value);
            complain(problem, size, "%s: expected %s, found \"%.*s\"", key->name, key->allowed,
                     length < 40 ? (int)length : 40, value);
            return false;
        }
    }
    return true;
}

kdr_status kdr_build_def_parse(const char *text, kdr_build_def *out, char *problem, size_t problem_size) {
    if (!problem)
        problem_size = 0;
    if (!text || !out) {
        complain(problem, problem_size, "expected a plan and where to put it, found NULL");
        return KDR_ERROR_INVALID_ARGUMENT;
    }
    /* Read it twice: the quality counts before all else, wherever it stands. */
    reading r = {.quality = KDR_QUALITY_BALANCED};
    locale_t plain, before = enter_plain_locale(&plain);
    bool parsed = true;
    for (int i = 0; i < 2 && parsed; i++) {
        r.def = kdr_quality_build_def(r.quality);
        parsed = parse(text, &r, problem, problem_size);
    }
    leave_plain_locale(before, plain);
    if (!parsed)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *wrong = kdr_build_def_problem(&r.def);
    if (wrong) {
        complain(problem, problem_size, "%s", wrong);
        return KDR_ERROR_INVALID_ARGUMENT;
    }
    *out = r.def;
    return KDR_OK;
}

/* ---- plan to text */

/* The shortest of two forms that is read back as the same float. */
static void print_real(float value, char *out, size_t size) {
    snprintf(out, size, "%g", (double)value);
    if (strtof(out, NULL) != value)
        snprintf(out, size, "%.9g", (double)value);
}

static void print_value(const plan_key *key, const kdr_build_def *def, char *out, size_t size) {
    const char *from = (const char *)def + key->offset;
    uint32_t whole, regions = 0;
    float real;
    memcpy(&whole, from, sizeof whole);
    memcpy(&real, from, sizeof real);
    if (key->kind == KEY_SHARE)
        memcpy(&regions, from + 4, sizeof regions);
    switch (key->kind) {
    case KEY_QUALITY: break;
    case KEY_CHOICE: snprintf(out, size, "%s", key->choice.names[whole]); break;
    case KEY_BOOL: snprintf(out, size, "%s", key->choice.names[*(const bool *)from]); break;
    case KEY_SHARE:
        snprintf(out, size, whole == KDR_SHARE_NONE ? "%s" : "%s/%" PRIu32, key->choice.names[whole], regions);
        break;
    case KEY_WHOLE: snprintf(out, size, "%" PRIu32, whole); break;
    case KEY_REAL: print_real(real, out, size); break;
    }
}

kdr_status kdr_build_def_print(const kdr_build_def *def, char *text, size_t size) {
    if (!def || !text || kdr_build_def_problem(def))
        return KDR_ERROR_INVALID_ARGUMENT;
    kdr_plan plan = kdr_plan_of(def);
    kdr_build_def resolved = *def;
    resolved.axis = plan.axis;
    resolved.leaf_limit = plan.leaf_limit;
    resolved.empty_bonus = plan.empty_bonus;

    char made[KDR_PLAN_TEXT_SIZE];
    size_t used = 0;
    locale_t plain, before = enter_plain_locale(&plain);
    for (size_t i = 0; i < KEY_COUNT; i++) {
        if (keys[i].kind == KEY_QUALITY)
            continue; /* the other keys say all of it */
        char value[WORD_SIZE];
        print_value(&keys[i], &resolved, value, sizeof value);
        used += (size_t)snprintf(made + used, sizeof made - used, "%s%s=%s", used > 0 ? " " : "", keys[i].name, value);
    }
    leave_plain_locale(before, plain);
    if (used >= size)
        return KDR_ERROR_LIMIT;
    memcpy(text, made, used + 1);
    return KDR_OK;
}
