#include "scenes/scenes.h"

#include "base/check.h"
#include "mesh/mesh.h"
#include "mesh/report.h"

#include <stdio.h>
#include <string.h>

#define RECIPE_ADDRESS(name) &kdr_recipe_##name,
static const kdr_recipe *const recipes[] = {KDR_RECIPE_LIST(RECIPE_ADDRESS)};
#define RECIPE_COUNT (sizeof recipes / sizeof recipes[0])

const kdr_recipe *kdr_recipe_at(size_t i) { return i < RECIPE_COUNT ? recipes[i] : NULL; }

const char *kdr_mesh_builtin_name(size_t i) { return i < RECIPE_COUNT ? recipes[i]->name : NULL; }

const char *kdr_mesh_builtin_text(size_t i) { return i < RECIPE_COUNT ? recipes[i]->text : NULL; }

bool kdr_mesh_builtin_moves(size_t i) { return i < RECIPE_COUNT && (recipes[i]->traits & KDR_SCENE_MOVING); }

static const kdr_recipe *find(const char *name) {
    for (size_t i = 0; i < RECIPE_COUNT; i++)
        if (strcmp(recipes[i]->name, name) == 0)
            return recipes[i];
    return NULL;
}

static kdr_status report_unknown(const kdr_logger *logger, const char *name) {
    char names[KDR_REPORT_BYTES / 2];
    size_t length = 0;
    for (size_t i = 0; i < RECIPE_COUNT; i++)
        length += (size_t)snprintf(names + length, sizeof names - length, "%s%s", i ? ", " : "", recipes[i]->name);
    return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "there is no built-in scene \"%.64s\"; there are %s", name,
                      names);
}

static kdr_status add_materials(kdr_mesh *mesh, const kdr_recipe *recipe) {
    for (uint32_t i = 0; i < recipe->material_count; i++) {
        const kdr_recipe_material *material = &recipe->materials[i];
        kdr_status status =
            kdr_mesh_add_material(mesh, material->name, strlen(material->name), material->diffuse, NULL);
        if (status != KDR_OK)
            return status;
    }
    return KDR_OK;
}

static kdr_status draw(const kdr_recipe *recipe, size_t triangle_count, double time, kdr_mesh **out) {
    kdr_shape counted = {0};
    recipe->draw(&counted, triangle_count, time);

    char format[sizeof((kdr_mesh *)0)->format];
    snprintf(format, sizeof format, "built-in %s", recipe->name);
    uint32_t parts = KDR_MESH_MATERIALS | (recipe->traits & KDR_SCENE_SMOOTH ? KDR_MESH_NORMALS : 0);
    kdr_status status = kdr_mesh_create(counted.vertex_count, counted.triangle_count, parts, format, out);
    if (status != KDR_OK)
        return status;
    status = add_materials(*out, recipe);
    if (status != KDR_OK) {
        kdr_mesh_destroy(*out);
        *out = NULL;
        return status;
    }

    kdr_mesh *mesh = *out;
    kdr_shape drawn = {.positions = mesh->positions,
                       .normals = mesh->normals,
                       .indices = mesh->indices,
                       .materials = mesh->triangle_materials};
    recipe->draw(&drawn, triangle_count, time);
    KDR_CHECK(drawn.vertex_count == counted.vertex_count && drawn.triangle_count == counted.triangle_count);
    return KDR_OK;
}

kdr_status kdr_mesh_make(const char *name, size_t triangle_count, double time, const kdr_logger *logger,
                         kdr_mesh **out) {
    if (!out)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "no place was given for the built-in scene");
    *out = NULL;
    if (!name)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT, "no name of a built-in scene was given");
    const kdr_recipe *recipe = find(name);
    if (!recipe)
        return report_unknown(logger, name);
    if (triangle_count == 0)
        triangle_count = recipe->default_count;
    if (triangle_count < KDR_SCENE_LEAST || triangle_count > KDR_SCENE_MOST)
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT,
                          "the built-in scene %s comes in sizes from %d to %d triangles, not %zu", name,
                          KDR_SCENE_LEAST, KDR_SCENE_MOST, triangle_count);
    if (!isfinite(time))
        return kdr_report(logger, KDR_ERROR_INVALID_ARGUMENT,
                          "the time of the built-in scene %s is not a finite number", name);

    kdr_status status = draw(recipe, triangle_count, time, out);
    if (status != KDR_OK)
        return kdr_report(logger, status, "the built-in scene %s of %zu triangles: %s", name, triangle_count,
                          kdr_status_text(status));
    return KDR_OK;
}
