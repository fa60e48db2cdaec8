/* A window: pixels go in, keys and the mouse come out. All that is known of SDL is in view_window.c. */
#ifndef KDR_APPS_KDRAY_VIEW_WINDOW_H
#define KDR_APPS_KDRAY_VIEW_WINDOW_H

#include "messages.h"

#include <stdint.h>

typedef struct kdr_window kdr_window;

typedef enum kdr_window_news {
    KDR_NEWS_NONE,
    KDR_NEWS_CLOSED,  /* somebody wants it closed */
    KDR_NEWS_CHANGED, /* its size, or it has to be shown again */
    KDR_NEWS_KEY,
    KDR_NEWS_PRESS, /* a button of the mouse */
    KDR_NEWS_RELEASE,
    KDR_NEWS_MOVE,
    KDR_NEWS_WHEEL,
} kdr_window_news;

enum { KDR_BUTTON_LEFT = 1, KDR_BUTTON_MIDDLE = 2, KDR_BUTTON_RIGHT = 3 };

typedef struct kdr_window_event {
    kdr_window_news news;
    char key[16]; /* its name: "A", "Space", "F1" */
    bool repeated, shift;
    int button;
    int x, y;       /* the mouse, pixels from the upper left corner */
    int by_x, by_y; /* how far it moved */
    double wheel;   /* turns, away from the hand */
} kdr_window_event;

/* True if there is a display. False after a sentence, also in a program that was built without windows. */
bool kdr_window_prepare(kdr_messages *messages);

/* Opens a window, after kdr_window_prepare. NULL after a sentence. */
kdr_window *kdr_window_open(const char *title, uint32_t width, uint32_t height, kdr_messages *messages);

/* NULL is allowed. Undoes kdr_window_prepare too. */
void kdr_window_close(kdr_window *window);

/* Pixels of the window now; each at least 1. */
void kdr_window_size(kdr_window *window, uint32_t *width, uint32_t *height);

/* What has happened; waits for that as long, in seconds. news NONE: nothing has. */
kdr_window_event kdr_window_next(kdr_window *window, double wait);

/* True while a key is held down, by the name as above. */
bool kdr_window_holds(const kdr_window *window, const char *key);

/* Shows width * height pixels 0x00RRGGBB, rows from the top. False after a sentence. */
bool kdr_window_show(kdr_window *window, uint32_t *pixels, uint32_t width, uint32_t height, kdr_messages *messages);

#endif
