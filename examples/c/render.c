/* Example: render a scene to pictures, with progress and Ctrl-C.
 *
 *     cc -std=c99 render.c $(pkg-config --cflags --libs photonmap) -o render
 *     ./render cornell-glass 16 glass.exr glass.png
 */
#include <photonmap.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static volatile sig_atomic_t stop;

static void interrupted(int signal)
{
    (void)signal;
    stop = 1;
}

static int32_t progress(void *user, const PmProgress *p)
{
    (void)user;
    fprintf(stderr, "\rpass %u of %u: %u of %u photon paths ", p->done + 1, p->count, p->traced, p->total);
    return stop;
}

/* Ends the program if a call has failed. */
static void check(PmStatus status)
{
    char text[1000];
    if (status != PM_STATUS_OK) {
        pm_last_error(text, sizeof text);
        fprintf(stderr, "\nerror %d: %s\n", (int)status, text);
        exit(1);
    }
}

int main(int argc, char **argv)
{
    PmScene *scene = NULL;
    PmRenderer *renderer = NULL;
    PmFilm *film = NULL;
    PmView view = {sizeof view, NULL, 96, 64};
    uint32_t done = 0;
    float exposure;
    char *end;
    long passes;
    PmStatus status;
    char text[1000];

    if (argc < 4 || pm_abi() != PM_ABI) {
        fprintf(stderr, "usage: %s SCENE PASSES PICTURE.exr|.png|.film...\n", argv[0]);
        return 2;
    }
    passes = strtol(argv[2], &end, 10);
    if (*end != '\0' || passes < 1 || passes > 1000000) {
        fprintf(stderr, "PASSES is %s, but must be a number from 1 to 1000000\n", argv[2]);
        return 2;
    }
    /* A file, or the name of a built-in scene. */
    check(strchr(argv[1], '.') ? pm_scene_load(argv[1], NULL, &scene) : pm_scene_builtin(argv[1], &scene));
    if (pm_scene_report(scene, text, sizeof text) > 0)
        fprintf(stderr, "%s\n", text);

    check(pm_renderer_new(scene, &view, "{\"photons\": 20000, \"errors\": true}", NULL, &renderer));
    pm_scene_free(scene);
    signal(SIGINT, interrupted);
    status = pm_renderer_passes(renderer, 0, (uint32_t)passes, progress, NULL, &done);
    if (status != PM_STATUS_CANCELLED) /* which leaves the passes until then */
        check(status);

    check(pm_renderer_take(renderer, &film));
    pm_renderer_free(renderer);
    check(pm_film_exposure(film, &exposure));
    for (int i = 3; i < argc; i++)
        check(pm_film_write(film, argv[i], exposure));
    pm_film_free(film);
    fprintf(stderr, "\n%u passes\n", done);
    return 0;
}
