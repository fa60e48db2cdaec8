/* Sphere flakes: a ball that carries nine balls a third of its size, each of which carries nine more, and so on; after
 * the figure "balls" of Haines, "A Proposal for Standard Graphics Environments", 1987.
 *
 * Every generation has the same area as the first, so all get an equal share of the triangles and all triangles are of
 * about one size. The last generation mixes two refinements to come close to the count asked for. */
#include "scenes/parts.h"

#define CHILDREN 9
#define MOST_GENERATIONS 8

typedef struct flake_plan {
    uint32_t generations;
    kdr_ball balls[MOST_GENERATIONS];
    size_t last_finer; /* balls of the last generation that are one level finer */
    size_t last_count;
    size_t last_drawn;
    uint32_t first_material, material_count;
} flake_plan;

static kdr_ball finer(kdr_ball ball) { return (kdr_ball){ball.sectors, ball.level + 1}; }

static flake_plan plan_flake(size_t triangles) {
    flake_plan plan = {.generations = 1, .last_count = 1};
    size_t count = 1;
    while (plan.generations < MOST_GENERATIONS &&
           kdr_ball_triangles((kdr_ball){4, 1}) * (plan.generations + 1) * count * CHILDREN <= triangles) {
        plan.generations++;
        count *= CHILDREN;
    }

    size_t left = triangles, balls = 1;
    for (uint32_t i = 0; i + 1 < plan.generations; i++, balls *= CHILDREN) {
        plan.balls[i] = kdr_ball_fit(left / (plan.generations - i) / balls);
        left -= kdr_ball_triangles(plan.balls[i]) * balls;
    }
    kdr_ball last = {4, (uint32_t)sqrt((double)(left / balls) / 8)};
    last.level = last.level ? last.level : 1;
    size_t coarse = kdr_ball_triangles(last) * balls;
    size_t step = kdr_ball_triangles(finer(last)) - kdr_ball_triangles(last);
    plan.balls[plan.generations - 1] = last;
    plan.last_count = balls;
    plan.last_finer = left > coarse ? (left - coarse) / step : 0;
    return plan;
}

static void draw_ball(kdr_shape *shape, flake_plan *flake, const kdr_frame *frame, uint32_t generation) {
    kdr_ball ball = flake->balls[generation];
    bool last = generation + 1 == flake->generations;
    if (last) {
        if (kdr_share(flake->last_finer, flake->last_count, flake->last_drawn))
            ball = finer(ball);
        flake->last_drawn++;
    }
    shape->material = flake->first_material + generation % flake->material_count;
    kdr_shape_ball(shape, frame, ball, NULL);
    if (last)
        return;

    // Six children around the waist, three around the top, each with its own top pointing away.
    for (int i = 0; i < CHILDREN; i++) {
        kdr_turn longitude = kdr_turn_of(i < 6 ? i / 6.0 : (i - 6) / 3.0 + 1 / 12.0);
        kdr_turn latitude = kdr_turn_of(i < 6 ? 0.25 : 0.0980);
        kdr_point away = {latitude.sine * longitude.sine, latitude.cosine, latitude.sine * longitude.cosine};
        away = kdr_frame_vector(frame, away.x, away.y, away.z);
        double radius = kdr_point_length(frame->y);
        kdr_frame child = kdr_frame_along(kdr_point_along(frame->origin, away, 4 / 3.0), away);
        child = kdr_frame_stretch(child, radius / 3, radius / 3, radius / 3);
        draw_ball(shape, flake, &child, generation + 1);
    }
}

void kdr_draw_flake(kdr_shape *shape, const kdr_frame *frame, size_t triangles, uint32_t first_material,
                    uint32_t material_count) {
    flake_plan flake = plan_flake(triangles);
    flake.first_material = first_material;
    flake.material_count = material_count;
    draw_ball(shape, &flake, frame, 0);
}

static const kdr_recipe_material materials[] = {
    {"plate", {0.55f, 0.55f, 0.58f}},   {"flake 1", {0.80f, 0.22f, 0.06f}}, {"flake 2", {0.85f, 0.42f, 0.08f}},
    {"flake 3", {0.88f, 0.62f, 0.16f}}, {"flake 4", {0.86f, 0.78f, 0.42f}}, {"flake 5", {0.85f, 0.85f, 0.80f}},
};

/* The plate takes up what the balls leave over, as segments of its rim. */
static void draw(kdr_shape *shape, size_t triangle_count, double time) {
    (void)time;
    size_t rim = triangle_count / 100 < 8 ? 8 : triangle_count / 100 > 96 ? 96 : triangle_count / 100;
    kdr_frame frame = kdr_frame_at((kdr_point){0, 1, 0}, 1);
    kdr_draw_flake(shape, &frame, triangle_count - rim, 1, 5);

    size_t left = triangle_count > shape->triangle_count ? triangle_count - shape->triangle_count : 0;
    shape->material = 0;
    kdr_frame plate = kdr_frame_at((kdr_point){0, 0, 0}, 2.1);
    kdr_shape_disc(shape, &plate, left < rim ? rim : left);
}

const kdr_recipe kdr_recipe_flake = {
    .name = "flake",
    .text = "a sphere flake on a plate: balls upon balls, a third as large each time",
    .default_count = 200000,
    .traits = KDR_SCENE_SMOOTH,
    .draw = draw,
    KDR_RECIPE_MATERIALS(materials),
};
