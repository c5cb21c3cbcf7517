#include "webp.h"

#include "base/files.h"

#include <cairo.h>
#include <stddef.h>
#include <webp/encode.h>

/* The last of so many frames. Opaque pictures: cairo has a pixel as one number, 0xaarrggbb, which
 * is what WebP calls BGRA where the low byte comes first. */
static int encode(struct webp *webp, cairo_surface_t *picture, int frames, double quality) {
    const int whole = cairo_image_surface_get_height(picture),
              stride = cairo_image_surface_get_stride(picture);
    webp->width = cairo_image_surface_get_width(picture);
    webp->height = whole / frames;
    webp->count = WebPEncodeBGRA(cairo_image_surface_get_data(picture) +
                                     (ptrdiff_t)stride * (whole - webp->height),
                                 webp->width, webp->height, stride, (float)quality, &webp->bytes);
    return webp->count > 0 ? 0 : -1;
}

int webp_of_png(struct webp *webp, const char *path, int frames, double quality, char *reason) {
    cairo_surface_t *picture = cairo_image_surface_create_from_png(path);
    const cairo_status_t status = cairo_surface_status(picture);
    int code = -1;
    *webp = (struct webp){0};
    if (status)
        snprintf(reason, REASON_SIZE, "%.150s: cannot be read: %s", path,
                 cairo_status_to_string(status));
    else if (encode(webp, picture, frames, quality))
        snprintf(reason, REASON_SIZE, "%.150s: cannot be coded as WebP", path);
    else
        code = 0;
    cairo_surface_destroy(picture);
    return code;
}

void webp_free(struct webp *webp) {
    WebPFree(webp->bytes);
}
