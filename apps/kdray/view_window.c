#include "view_window.h"

#ifdef KDR_WITH_SDL

#include "memory.h"

#include <SDL.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct kdr_window {
    SDL_Window *window;
    bool shift; /* is down, at the last event that was taken */
};

bool kdr_window_prepare(kdr_messages *messages) {
    // Where there is no display, SDL takes a driver that shows nothing and says nothing, and what it tries before that
    // says too much.
    const char *x11 = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY"), *asked = getenv("SDL_VIDEODRIVER");
    bool has_x11 = x11 && *x11, has_wayland = wayland && *wayland, is_asked = asked && *asked;
    if (!has_x11 && !has_wayland && !is_asked) {
        kdr_messages_fail(messages, "there is no display for a window: neither DISPLAY nor WAYLAND_DISPLAY is set");
        return false;
    }
    if (has_x11 && !has_wayland)
        SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11"); // SDL_VIDEODRIVER counts more

    // Ctrl-C is the program's, as in every other command.
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    // Pixels go to the screen as they are; a driver for triangles would take threads from the tracer.
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    if (SDL_Init(SDL_INIT_VIDEO) != 0) {
        kdr_messages_fail(messages, "there is no display for a window: %s", SDL_GetError());
        return false;
    }
    const char *driver = SDL_GetCurrentVideoDriver();
    bool shows = driver && strcmp(driver, "offscreen") != 0 && strcmp(driver, "dummy") != 0;
    if (shows || is_asked)
        return true;
    SDL_Quit();
    kdr_messages_fail(messages, "there is no display for a window: SDL found none to open");
    return false;
}

kdr_window *kdr_window_open(const char *title, uint32_t width, uint32_t height, kdr_messages *messages) {
    SDL_Window *made = SDL_CreateWindow(title, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, (int)width, (int)height,
                                        SDL_WINDOW_RESIZABLE);
    if (!made) {
        kdr_messages_fail(messages, "no window was opened: %s", SDL_GetError());
        SDL_Quit();
        return NULL;
    }
    kdr_window *window = kdr_memory_get(1, sizeof *window);
    *window = (kdr_window){.window = made};
    return window;
}

void kdr_window_close(kdr_window *window) {
    if (!window)
        return;
    SDL_DestroyWindow(window->window);
    kdr_memory_release(window);
    SDL_Quit();
}

void kdr_window_size(kdr_window *window, uint32_t *width, uint32_t *height) {
    int size[2];
    SDL_GetWindowSize(window->window, &size[0], &size[1]);
    *width = size[0] > 0 ? (uint32_t)size[0] : 1;
    *height = size[1] > 0 ? (uint32_t)size[1] : 1;
}

/* Whether Shift is down is what the keys before an event say: the state that SDL tells is that of the last event that
 * has come, which may be far behind in the queue. */
static kdr_window_event translate(kdr_window *window, const SDL_Event *from) {
    if (from->type == SDL_KEYDOWN || from->type == SDL_KEYUP)
        window->shift = (from->key.keysym.mod & KMOD_SHIFT) != 0;
    kdr_window_event event = {.news = KDR_NEWS_NONE, .shift = window->shift};
    switch (from->type) {
    case SDL_QUIT: event.news = KDR_NEWS_CLOSED; break;
    case SDL_WINDOWEVENT:
        if (from->window.event == SDL_WINDOWEVENT_FOCUS_LOST)
            window->shift = false;
        if (from->window.event == SDL_WINDOWEVENT_SIZE_CHANGED || from->window.event == SDL_WINDOWEVENT_EXPOSED)
            event.news = KDR_NEWS_CHANGED;
        break;
    case SDL_KEYDOWN:
        event.news = KDR_NEWS_KEY;
        event.repeated = from->key.repeat != 0;
        snprintf(event.key, sizeof event.key, "%s", SDL_GetKeyName(from->key.keysym.sym));
        break;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
        event.news = from->type == SDL_MOUSEBUTTONDOWN ? KDR_NEWS_PRESS : KDR_NEWS_RELEASE;
        event.button = from->button.button;
        event.x = from->button.x;
        event.y = from->button.y;
        break;
    case SDL_MOUSEMOTION:
        event.news = KDR_NEWS_MOVE;
        event.x = from->motion.x;
        event.y = from->motion.y;
        event.by_x = from->motion.xrel;
        event.by_y = from->motion.yrel;
        break;
    case SDL_MOUSEWHEEL:
        event.news = KDR_NEWS_WHEEL;
        event.wheel = (double)from->wheel.preciseY * (from->wheel.direction == SDL_MOUSEWHEEL_FLIPPED ? -1 : 1);
        break;
    default: break;
    }
    return event;
}

kdr_window_event kdr_window_next(kdr_window *window, double wait) {
    SDL_Event from;
    int milliseconds = (int)(1e3 * wait);
    // What means nothing here does not end the waiting, but what comes behind it counts from now.
    while (milliseconds > 0 ? SDL_WaitEventTimeout(&from, milliseconds) : SDL_PollEvent(&from)) {
        kdr_window_event event = translate(window, &from);
        if (event.news != KDR_NEWS_NONE)
            return event;
        milliseconds = 0;
    }
    return (kdr_window_event){.news = KDR_NEWS_NONE};
}

bool kdr_window_holds(const kdr_window *window, const char *key) {
    (void)window;
    return SDL_GetKeyboardState(NULL)[SDL_GetScancodeFromKey(SDL_GetKeyFromName(key))] != 0;
}

bool kdr_window_show(kdr_window *window, uint32_t *pixels, uint32_t width, uint32_t height, kdr_messages *messages) {
    // The surface is another one after the size has changed; what lies outside is left out.
    SDL_Surface *surface = SDL_GetWindowSurface(window->window);
    SDL_Surface *picture =
        SDL_CreateRGBSurfaceWithFormatFrom(pixels, (int)width, (int)height, 32, (int)width * 4, SDL_PIXELFORMAT_RGB888);
    bool shown = surface && picture && SDL_BlitSurface(picture, NULL, surface, NULL) == 0 &&
                 SDL_UpdateWindowSurface(window->window) == 0;
    SDL_FreeSurface(picture);
    if (!shown)
        kdr_messages_fail(messages, "the window cannot be drawn: %s", SDL_GetError());
    return shown;
}

#else

bool kdr_window_prepare(kdr_messages *messages) {
    kdr_messages_fail(messages, "this kdray was built without SDL2, so it opens no window");
    return false;
}

kdr_window *kdr_window_open(const char *title, uint32_t width, uint32_t height, kdr_messages *messages) {
    (void)title;
    (void)width;
    (void)height;
    (void)messages;
    return NULL;
}

void kdr_window_close(kdr_window *window) { (void)window; }

void kdr_window_size(kdr_window *window, uint32_t *width, uint32_t *height) {
    (void)window;
    *width = *height = 1;
}

kdr_window_event kdr_window_next(kdr_window *window, double wait) {
    (void)window;
    (void)wait;
    return (kdr_window_event){.news = KDR_NEWS_CLOSED};
}

bool kdr_window_holds(const kdr_window *window, const char *key) {
    (void)window;
    (void)key;
    return false;
}

bool kdr_window_show(kdr_window *window, uint32_t *pixels, uint32_t width, uint32_t height, kdr_messages *messages) {
    (void)window;
    (void)pixels;
    (void)width;
    (void)height;
    (void)messages;
    return false;
}

#endif
