/* A library with the part of the interface of Open Image Denoise 2 that the program uses, for its tests: it "denoises" to
   twice the colour plus the albedo plus the normal. The version is 2.3.4. If the environment variable FAILS is set, executing
   the filter fails. */
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

struct image { float *data; size_t width, height; };
static struct image color, albedo, normal, output;
static bool hdr, committed;
static int created, released;
static const char *error;

void *oidnNewDevice(int type) { created++; return type == 1 ? &created : NULL; }
void oidnCommitDevice(void *device) { (void)device; }
void oidnReleaseDevice(void *device) { (void)device; released++; }
int oidnGetDeviceInt(void *device, const char *name) { (void)device; return strcmp(name, "version") == 0 ? 20304 : 0; }
int oidnGetDeviceError(void *device, const char **message) {
  (void)device;
  *message = error;
  int code = error ? 3 : 0;
  error = NULL;
  return code;
}
void *oidnNewFilter(void *device, const char *type) { (void)device; return strcmp(type, "RT") == 0 ? &hdr : NULL; }
void oidnReleaseFilter(void *filter) { (void)filter; }
void oidnSetSharedFilterImage(void *filter, const char *name, void *data, int format, size_t width, size_t height,
                              size_t offset, size_t pixel_stride, size_t row_stride) {
  (void)filter;
  struct image image = {data, width, height};
  if (format != 3 || offset != 0 || pixel_stride != 0 || row_stride != 0) error = "an unexpected layout";
  if (strcmp(name, "color") == 0) color = image;
  else if (strcmp(name, "albedo") == 0) albedo = image;
  else if (strcmp(name, "normal") == 0) normal = image;
  else if (strcmp(name, "output") == 0) output = image;
  else error = "an unexpected image";
}
void oidnSetFilterBool(void *filter, const char *name, bool value) {
  (void)filter;
  if (strcmp(name, "hdr") == 0) hdr = value;
}
void oidnCommitFilter(void *filter) { (void)filter; committed = true; }
void oidnExecuteFilter(void *filter) {
  (void)filter;
  if (getenv("FAILS")) { error = "it is meant to fail"; return; }
  if (!hdr || !committed || !color.data || !albedo.data || !normal.data || !output.data) { error = "incomplete"; return; }
  for (size_t i = 0; i < 3 * output.width * output.height; i++) {
    output.data[i] = 2.0f * color.data[i] + albedo.data[i] + normal.data[i];
  }
}
