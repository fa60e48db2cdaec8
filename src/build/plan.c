/* The plan of a build as text: one table of keys, which prints, parses and explains itself. */
#include "build/plan.h"

#include "tree/tree.h"

#include <inttypes.h>
#include <locale.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BINNED_LEAF_LIMIT 64
#define MEDIAN_LEAF_LIMIT 8 /* half a block of the widest lanes: medians never ask whether a leaf would do */
#define COST_LIMIT 1e6
#define WORD_SIZE 48 /* bytes of the longest number that is read, with its end */

kdr_build_def kdr_default_build_def(void) {
    return (kdr_build_def){
        .size = sizeof(kdr_build_def), .cost_traversal = 16, .cost_intersection = 1, .reference_limit = 4};
}

/* Comparisons are written so that NaN is wrong. */
const char *kdr_build_def_problem(const kdr_build_def *def) {
    if (def->size != sizeof(kdr_build_def))
        return "the build def was not made by kdr_default_build_def";
    if ((unsigned)def->split > KDR_SPLIT_OBJECT)
        return "split must be one of kdr_split_rule";
    if ((unsigned)def->axis > KDR_AXIS_ROBIN)
        return "axis must be one of kdr_axis_rule";
    if (!(def->cost_traversal > 0 && (double)def->cost_traversal <= COST_LIMIT))
        return "cost_traversal must be over 0 and at most 1,000,000";
    if (!(def->cost_intersection > 0 && (double)def->cost_intersection <= COST_LIMIT))
        return "cost_intersection must be over 0 and at most 1,000,000";
    if (def->depth_limit > KDR_MAX_DEPTH)
        return "depth_limit must be at most 60";
    if (!(def->reference_limit >= 1 && (double)def->reference_limit <= COST_LIMIT))
        return "reference_limit must be at least 1 and at most 1,000,000";
    if ((unsigned)def->trace > KDR_TRACE_BACKTRACK)
        return "trace must be one of kdr_trace_rule";
    if ((unsigned)def->nodes > KDR_NODES_ARRAYS)
        return "nodes must be one of kdr_nodes_rule";
    if ((unsigned)def->mailbox > KDR_MAILBOX_64)
        return "mailbox must be one of kdr_mailbox_rule";
    if (def->nodes == KDR_NODES_ARRAYS && def->trace != KDR_TRACE_STACK && def->trace != KDR_TRACE_RESTART)
        return "nodes=arrays goes with trace=stack or trace=restart";
    if (def->mailbox != KDR_MAILBOX_NONE && def->trace == KDR_TRACE_AUTO)
        return "a mailbox goes with a traversal by name, not with trace=auto";
    return NULL;
}

kdr_plan kdr_plan_of(const kdr_build_def *def) {
    bool binned = def->split == KDR_SPLIT_BINNED;
    kdr_plan plan = {.split = def->split,
                     .axis = def->axis,
                     .cost_traversal = def->cost_traversal,
                     .cost_intersection = def->cost_intersection,
                     .leaf_limit = def->leaf_limit,
                     .depth_limit = def->depth_limit,
                     .reference_limit = def->reference_limit,
                     .trace = def->trace,
                     .nodes = def->nodes,
                     .mailbox = def->mailbox};
    if (plan.axis == KDR_AXIS_DEFAULT)
        plan.axis = binned ? KDR_AXIS_BEST : KDR_AXIS_LONGEST;
    if (plan.leaf_limit == 0)
        plan.leaf_limit = binned ? BINNED_LEAF_LIMIT : MEDIAN_LEAF_LIMIT;
    return plan;
}

/* One of a few words: its number is the value. An empty name has no word. */
typedef struct key_choice {
    const char *const *names;
    int count;
} key_choice;

static const char *const split_names[] = {"binned", "space", "object"};
static const char *const axis_names[] = {"", "best", "longest", "robin"};
static const char *const trace_names[] = {"auto", "stack", "restart", "push-down", "short-stack", "backtrack"};
static const char *const nodes_names[] = {"structures", "arrays"};
static const char *const mailbox_names[] = {"0", "8", "16", "32", "64"};

/* How a key's value is held in a def: as a word of a list, a whole number or a real one. */
typedef enum key_kind { KEY_CHOICE, KEY_WHOLE, KEY_REAL } key_kind;

typedef struct plan_key {
    const char *name, *allowed; /* allowed: as it follows "expected" */
    const char *text;
    size_t offset; /* in kdr_build_def */
    key_kind kind;
    key_choice choice;
    double min, max;
    bool above_min; /* min itself is not allowed */
} plan_key;

static const plan_key keys[] = {
    {.name = "split",
     .allowed = "binned, space or object",
     .text = "binned|space|object, default binned: where the surface area heuristic says, the middle of the cell, "
             "or the median of the primitives",
     .offset = offsetof(kdr_build_def, split),
     .kind = KEY_CHOICE,
     .choice = {split_names, 3}},
    {.name = "axis",
     .allowed = "best, longest or robin",
     .text = "best|longest|robin, default best for binned, longest for space and object: the axis that costs least, "
             "the longest of the cell, or each in turn",
     .offset = offsetof(kdr_build_def, axis),
     .kind = KEY_CHOICE,
     .choice = {axis_names, 4}},
    {.name = "traversal-cost",
     .allowed = "a number above 0 and at most 1e+06",
     .text = "above 0 to 1e+06, default 16: cost of a step through an interior node",
     .offset = offsetof(kdr_build_def, cost_traversal),
     .kind = KEY_REAL,
     .max = COST_LIMIT,
     .above_min = true},
    {.name = "intersection-cost",
     .allowed = "a number above 0 and at most 1e+06",
     .text = "above 0 to 1e+06, default 1: cost of a triangle test",
     .offset = offsetof(kdr_build_def, cost_intersection),
     .kind = KEY_REAL,
     .max = COST_LIMIT,
     .above_min = true},
    {.name = "leaf-limit",
     .allowed = "a whole number from 1 to 4294967295",
     .text = "1 to 4294967295, default 64 for binned, 8 for space and object: split every leaf of more triangles",
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
     .allowed = "a number from 1 to 1e+06",
     .text = "1 to 1e+06, default 4: most references a triangle",
     .offset = offsetof(kdr_build_def, reference_limit),
     .kind = KEY_REAL,
     .min = 1,
     .max = COST_LIMIT},
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
};
enum { KEY_COUNT = sizeof keys / sizeof keys[0] };

/* Choices are enums, whole numbers are uint32_t: all are read and written as four bytes. */
_Static_assert(sizeof(kdr_split_rule) == 4 && sizeof(kdr_axis_rule) == 4 && sizeof(kdr_trace_rule) == 4 &&
                   sizeof(kdr_nodes_rule) == 4 && sizeof(kdr_mailbox_rule) == 4 && sizeof(float) == 4,
               "values of four bytes");

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

static bool read_value(const plan_key *key, const char *text, size_t length, kdr_build_def *def) {
    void *to = (char *)def + key->offset;
    if (key->kind == KEY_CHOICE) {
        for (int i = 0; i < key->choice.count; i++) {
            if (length > 0 && strlen(key->choice.names[i]) == length &&
                memcmp(key->choice.names[i], text, length) == 0) {
                memcpy(to, &i, sizeof i);
                return true;
            }
        }
        return false;
    }
    double value;
    if (!read_number(text, length, key->kind == KEY_WHOLE ? "0123456789" : "0123456789+-.eE", &value))
        return false;
    if (key->kind == KEY_WHOLE) {
        uint32_t whole = value >= key->min && value <= key->max ? (uint32_t)value : 0;
        memcpy(to, &whole, sizeof whole);
        return value >= key->min && value <= key->max;
    }
    /* Rounding must not lead out of the range either. */
    float real = value <= key->max ? (float)value : INFINITY;
    memcpy(to, &real, sizeof real);
    return (double)real <= key->max && (key->above_min ? (double)real > key->min : (double)real >= key->min);
}

static const plan_key *find_key(const char *name, size_t length) {
    for (size_t i = 0; i < KEY_COUNT; i++)
        if (strlen(keys[i].name) == length && memcmp(keys[i].name, name, length) == 0)
            return &keys[i];
    return NULL;
}

static void complain_of_key(char *problem, size_t size, const char *word, int length) {
    char names[240] = "";
    size_t used = 0;
    for (size_t i = 0; i < KEY_COUNT; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s",
                                 i == 0 ? "" : (i + 1 < KEY_COUNT ? ", " : " or "), keys[i].name);
    complain(problem, size, "expected KEY=VALUE with one of the keys %s, found \"%.*s\"", names, length, word);
}

static bool parse(const char *text, kdr_build_def *def, char *problem, size_t size) {
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
        if (!read_value(key, value, (size_t)(at - value), def)) {
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
    kdr_build_def def = kdr_default_build_def();
    locale_t plain, before = enter_plain_locale(&plain);
    bool parsed = parse(text, &def, problem, problem_size);
    leave_plain_locale(before, plain);
    if (!parsed)
        return KDR_ERROR_INVALID_ARGUMENT;
    const char *wrong = kdr_build_def_problem(&def);
    if (wrong) {
        complain(problem, problem_size, "%s", wrong);
        return KDR_ERROR_INVALID_ARGUMENT;
    }
    *out = def;
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
    const void *from = (const char *)def + key->offset;
    uint32_t whole;
    float real;
    memcpy(&whole, from, sizeof whole);
    memcpy(&real, from, sizeof real);
    switch (key->kind) {
    case KEY_CHOICE: snprintf(out, size, "%s", key->choice.names[whole]); break;
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

    char made[KDR_PLAN_TEXT_SIZE];
    size_t used = 0;
    locale_t plain, before = enter_plain_locale(&plain);
    for (size_t i = 0; i < KEY_COUNT; i++) {
        char value[WORD_SIZE];
        print_value(&keys[i], &resolved, value, sizeof value);
        used += (size_t)snprintf(made + used, sizeof made - used, "%s%s=%s", i > 0 ? " " : "", keys[i].name, value);
    }
    leave_plain_locale(before, plain);
    if (used >= size)
        return KDR_ERROR_LIMIT;
    memcpy(text, made, used + 1);
    return KDR_OK;
}
