/* What a benchmark scene is called, and how it is looked at. */
#ifndef KDR_APPS_KDRAY_SCENE_VIEW_H
#define KDR_APPS_KDRAY_SCENE_VIEW_H

#include "bench.h"
#include "messages.h"

/* A file's name without folder and ending; a built-in scene's as it is. */
void kdr_scene_name(const char *path, char name[KDR_BENCH_SCENE_SIZE]);

/* Sets camera and light of a scene that has its bounds: those of a .cam file beside the mesh, or three quarters from
 * above. False after a sentence. */
bool kdr_scene_view(const char *path, kdr_bench_scene *scene, kdr_messages *messages, const kdr_logger *logger);

#endif
