// In a PLY the radius is called `pscale`, Houdini's attribute for a particle's radius. Blender imports it under this name, like every
// property that it does not use itself.
#include "io/volume/spheres.h"

#include <bit>

#include "core/text/numbers.h"

namespace cloudbake {

namespace {

std::string encodePly(std::span<const Sphere> spheres) {
  std::string ply = "ply\nformat binary_little_endian 1.0\ncomment spheres: pscale is the radius\nelement vertex " +
                    std::to_string(spheres.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty float pscale\nend_header\n";
  ply.reserve(ply.size() + spheres.size() * 16);
  for (const Sphere& s : spheres)
    for (const float value : {s.center.x, s.center.y, s.center.z, s.radius})
      for (int shift = 0; shift < 32; shift += 8) ply += char(std::bit_cast<uint32_t>(value) >> shift & 0xFF);
  return ply;
}

std::string encodeCsv(std::span<const Sphere> spheres) {
  std::string csv = "x,y,z,radius\n";
  for (const Sphere& s : spheres) {
    for (const float value : {s.center.x, s.center.y, s.center.z, s.radius}) csv += shortestText(value) + ',';
    csv.back() = '\n';
  }
  return csv;
}

}  // namespace

std::string encodeSpheres(std::span<const Sphere> spheres, SphereFormat format) {
  return format == SphereFormat::kPly ? encodePly(spheres) : encodeCsv(spheres);
}

}  // namespace cloudbake
