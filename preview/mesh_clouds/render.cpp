// "On Mesh Cloud Rendering" (2019-06-30), after Sea of Thieves (SIGGRAPH 2018), its last step, on the fields R and G of
// preview/mesh_clouds/lit_mesh.h:
//   C = lerp(ambient_ground, sun_color, R) + lerp(ambient_ground, ambient_sky, G), times the cloud's own colour
// Soft edges: along a view ray the cloud fills intervals [a, b] between the surface's crossings, where the winding number
// is not 0. Each interval absorbs as a medium of extinction σ_v and shines in a colour that runs from C(a) to C(b),
//   ∫₀^τ e^{−x} (C(a) + (C(b) − C(a))·x/τ) dx = C(a)(1 − e^{−τ}) + (C(b) − C(a))·((1 − e^{−τ})/τ − e^{−τ}),   τ = σ_v (b − a),
// front to back: thick cloud shows C(a) alone, and thin edges let the sky through. All of this is computed in the frame of lit_mesh, where
// the mesh is centred and its longest side is 1.
#include "preview/mesh_clouds/render.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/srgb.h"
#include "preview/mesh_clouds/pixel_triangles.h"
#include "preview/mesh_clouds/tone_kernels.h"

namespace cloudbake {

namespace {

bool shareCorner(const LitMesh& lit, uint32_t first, uint32_t second) {
  for (const uint32_t v : lit.triangles[first])
    for (const uint32_t w : lit.triangles[second])
      if (lit.positions[v] == lit.positions[w]) return true;
  return false;
}

// A ray through an edge meets both of its triangles. They are one crossing, recognised by place, sense and a shared corner.
void dropRepeated(const LitMesh& lit, std::vector<Crossing>& crossings) {
  constexpr float kSamePlace = 1e-6F;  // in the frame, where the mesh has size 1
  size_t kept = 0;
  for (const Crossing& crossing : crossings) {
    bool repeated = false;
    for (size_t j = kept; j-- > 0 && crossing.t - crossings[j].t <= kSamePlace && !repeated;)
      repeated = crossings[j].sign == crossing.sign && shareCorner(lit, crossings[j].triangle, crossing.triangle);
    if (!repeated) crossings[kept++] = crossing;
  }
  crossings.resize(kept);
}

Vec3 colorAt(const Crossing& crossing, const SkyColors& colors) { return cloudColor(crossing.shade, colors) * crossing.color; }

// The cloud's intervals over the sky, front to back; σ_v and crossings in the frame.
template <class Sky>
Vec3 colorAlong(const std::vector<Crossing>& crossings, float view_extinction, const SkyColors& colors, const LightSettings& light,
                const Sky& sky) {
  if (crossings.empty()) return sky();
  int sum = 0;
  for (const Crossing& crossing : crossings) sum += crossing.sign;
  if (sum != 0 || !(view_extinction > 0)) return colorAt(crossings.front(), colors);

  Vec3 color;
  float through = 1;  // transmittance so far
  int winding = 0;
  const Crossing* entry = nullptr;
  for (const Crossing& crossing : crossings) {
    if (winding == 0) entry = &crossing;
    winding += crossing.sign;
    if (winding != 0) continue;
    const float depth = view_extinction * (crossing.t - entry->t), passed = std::exp(-depth);
    const float later = depth > 1e-3F ? (1 - passed) / depth - passed : 0.5F * depth;
    const Crossing& first = light.first_surface ? crossings.front() : *entry;
    const Vec3 near = colorAt(first, colors), far = light.first_surface ? near : colorAt(crossing, colors);
    color += (near * (1 - passed) + (far - near) * later) * through;
    through *= passed;
  }
  return color + sky() * through;
}

// `extinction` is the mesh's σ per world unit.
Image renderLit(LitMesh lit, float extinction, const Camera& camera, const LightSettings& light, const Image* sky = nullptr) {
  const float view_extinction = light.view_extinction * extinction * lit.size;
  Camera local = camera;
  local.look_from = lit.toFrame(camera.look_from);
  local.look_at = lit.toFrame(camera.look_at);
  const std::vector<Vec2> places = pixelPlaces(light.samples_per_side);
  const SkyColors colors = lightColors(light.sky);

  Image image = blankImage(camera.width, camera.height);
  const CameraRays rays(local);
  const auto pixels = places.size() == 1 ? PixelTriangles::of(lit.positions, lit.triangles, local) : std::nullopt;
  if (!pixels) prepareForRays(lit, light.rays);
  parallelFor(camera.height, [&](int y) {
    std::vector<Crossing> crossings;
    const PixelTriangles::Row row = pixels ? pixels->row(y) : PixelTriangles::Row{};
    for (int x = 0; x < camera.width; ++x) {
      if (pixels && sky && row.at(x).empty()) {
        image.at(x, y) = sky->at(x, y);
        continue;
      }
      Vec3 sum;
      for (const Vec2 place : places) {
        const Ray ray = rays.at(float(x) + place.x, float(y) + place.y);
        if (pixels)
          findCrossings(lit, ray, row.at(x), crossings);
        else
          findCrossings(lit, ray, crossings);
        dropRepeated(lit, crossings);
        const auto sky_color = [&] { return sky ? sky->at(x, y) : skyColor(ray.direction, light.sky); };
        sum += colorAlong(crossings, view_extinction, colors, light, sky_color);
      }
      image.at(x, y) = sum / float(places.size());
    }
  });
  return image;
}

}  // namespace

Image renderLobe(const BakedMesh& mesh, const Camera& camera, const LightSettings& light, const Image* sky) {
  const Instance instance{&mesh, {}};
  return renderLit(lightMeshes({&instance, 1}, light), worldExtinction(instance, light), camera, light, sky);
}

Image renderShaded(const BakedMesh& mesh, std::span<const Shade> shades, const Camera& camera, const LightSettings& light) {
  return renderLit(shadedMesh(mesh, shades), worldExtinction({&mesh, {}}, light), camera, light);
}

void toneRow(std::span<Vec3> colors, float exposure) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  if (!colors.empty()) encodeTones(&colors[0].x, 3 * colors.size(), exposure);
}

Image toneMap(Image image, float exposure) {
  parallelFor(image.height, [&](int y) { toneRow(std::span(&image.at(0, y), size_t(image.width)), exposure); });
  return image;
}

// IEC 61966-2-1.
Image linearOfSrgb(Image srgb) {
  for (Vec3& p : srgb.pixels) p = {linearOfSrgb(p.x), linearOfSrgb(p.y), linearOfSrgb(p.z)};
  return srgb;
}

// B. Bayer, "An optimum method for two-level rendition of continuous-tone pictures" (1973): bits of x^y and y, interleaved in reverse.
Image dithered(Image tone_mapped) {
  for (int y = 0; y < tone_mapped.height; ++y)
    for (int x = 0; x < tone_mapped.width; ++x) {
      int rank = 0;
      for (int bit = 0; bit < 3; ++bit) rank = rank << 2 | ((x ^ y) >> bit & 1) << 1 | (y >> bit & 1);
      const float offset = ((float(rank) + 0.5F) / 64 - 0.5F) / 255;
      tone_mapped.at(x, y) += Vec3{offset, offset, offset};
    }
  return tone_mapped;
}

}  // namespace cloudbake
