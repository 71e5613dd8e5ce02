// Settings as text, field by field: two runs are asked for the same where the texts are equal. The bindings name every field, so that a new
// one does not compile before it is here.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "pipeline/settings.h"

namespace cloudbake {

inline auto fieldsOf(const Length& s) {
  const auto& [value, relative] = s;
  return std::tie(value, relative);
}
inline auto fieldsOf(const ReadSettings& s) {
  const auto& [metres, up, outside, scene, memory, program, reader] = s;  // no option sets the reader
  return std::tie(metres, up, outside, scene, memory, program);
}
inline auto fieldsOf(const VdbSettings& s) {
  const auto& [grid, iso, memory] = s;
  return std::tie(grid, iso, memory);
}
inline auto fieldsOf(const SourceSettings& s) {
  const auto& [kind, input, keys, read, volume, memory, explain, spheres_only] = s;
  return std::tie(kind, input, keys, read, volume, memory, explain, spheres_only);
}
inline auto fieldsOf(const RepairSettings& s) {
  const auto& [orient, fill] = s;
  return std::tie(orient, fill);
}
inline auto fieldsOf(const LevelSize& s) {
  const auto& [value, is_share] = s;
  return std::tie(value, is_share);
}
inline auto fieldsOf(const MeshSettings& s) {
  const auto& [vertices, remesh, refine, repair, repair_remesh, close, separate, levels, inspect, memory] = s;
  return std::tie(vertices, remesh, refine, repair, repair_remesh, close, separate, levels, inspect, memory);
}
inline auto fieldsOf(const FieldSettings& s) {
  const auto& [kind, voxels, voxel_size, bake_voxels, blend, flat_base, noise, noise_size, noise_octaves, noise_seed, memory] = s;
  return std::tie(kind, voxels, voxel_size, bake_voxels, blend, flat_base, noise, noise_size, noise_octaves, noise_seed, memory);
}
inline auto fieldsOf(const BakeSettings& s) {
  const auto& [method, sampler, quadrature, rays, steps, ray_length, seed, rotate] = s;
  return std::tie(method, sampler, quadrature, rays, steps, ray_length, seed, rotate);
}
inline auto fieldsOf(const TargetError& s) {
  const auto& [value, is_transmittance] = s;
  return std::tie(value, is_transmittance);
}
inline auto fieldsOf(const SunArc& s) {
  const auto& [elevation_low, elevation_high, azimuth_low, azimuth_high] = s;
  return std::tie(elevation_low, elevation_high, azimuth_low, azimuth_high);
}
inline auto fieldsOf(const OctaveSettings& s) {
  const auto& [count, extinction, contribution, eccentricity] = s;
  return std::tie(count, extinction, contribution, eccentricity);
}
inline auto fieldsOf(const VolumeChoices& s) {
  const auto& [view_extinction, asymmetry, octaves] = s;
  return std::tie(view_extinction, asymmetry, octaves);
}
inline auto fieldsOf(const LobeSettings& s) {
  const auto& [bake, target, fit, fit_exponent, fit_bias, to_volume, volume, exponent, bias, extinction, arc, order, cells, smooth,
               memory] = s;
  return std::tie(bake, target, fit, fit_exponent, fit_bias, to_volume, volume, exponent, bias, extinction, arc, order, cells, smooth,
                  memory);
}
inline auto fieldsOf(const GltfSettings& s) {
  const auto& [uv_set, attribute, texture] = s;
  return std::tie(uv_set, attribute, texture);
}
inline auto fieldsOf(const OutputSettings& s) {
  const auto& [file, gltf, lattice, spheres, vdb] = s;
  return std::tie(file, gltf, lattice, spheres, vdb);
}
inline auto fieldsOf(const PictureSettings& s) {
  const auto& [sun_azimuth, sun_elevation, azimuth, elevation, fov, width, height, is_sized, exposure, plain, time, channels, steps,
               lobes_only, draft, compare, suns, motion, frame_count, rate, frames, memory] = s;
  return std::tie(sun_azimuth, sun_elevation, azimuth, elevation, fov, width, height, is_sized, exposure, plain, time, channels, steps,
                  lobes_only, draft, compare, suns, motion, frame_count, rate, frames, memory);
}
inline auto fieldsOf(const ErrorBounds& s) {
  const auto& [angle, transmittance, surface] = s;
  return std::tie(angle, transmittance, surface);
}
inline auto fieldsOf(const JudgeSettings& s) {
  const auto& [against, lattice, bounds, vertices, memory] = s;
  return std::tie(against, lattice, bounds, vertices, memory);
}
inline auto fieldsOf(const BatchOrders& s) {
  const auto& [crashed, alone, done] = s;
  return std::tie(crashed, alone, done);
}
inline auto fieldsOf(const BatchSettings& s) {
  const auto& [inputs, list, name, cache, junit, html, depfile, target, fail_fast, prune, init, merge, dry_run, live, orders, shard,
               shards] = s;
  return std::tie(inputs, list, name, cache, junit, html, depfile, target, fail_fast, prune, init, merge, dry_run, live, orders, shard,
                  shards);
}
inline auto fieldsOf(const ServeSettings& s) {
  const auto& [port, watch] = s;
  return std::tie(port, watch);
}
inline auto fieldsOf(const RunSettings& s) {
  const auto& [json, threads, memory, strict, quiet, force] = s;
  return std::tie(json, threads, memory, strict, quiet, force);
}
inline auto fieldsOf(const Settings& s) {
  const auto& [source, mesh, field, lobe, output, picture, scene, judge, batch, serve, run] = s;
  return std::tie(source, mesh, field, lobe, output, picture, scene, judge, batch, serve, run);
}

// One function, so that types of the standard library find it whatever holds them.
template <class Value>
std::string textOf(const Value& value) {
  if constexpr (requires { value.has_value(); }) {
    return value ? textOf(*value) : "-";
  } else if constexpr (requires { value.second; }) {
    return textOf(value.first) + "=" + textOf(value.second);
  } else if constexpr (
      requires { value.begin(); } && !requires { value.c_str(); }) {
    std::string text = "[";
    for (const auto& one : value) text += " " + textOf(one);
    return text + " ]";
  } else if constexpr (requires { std::filesystem::path(value); }) {
    return "'" + std::filesystem::path(value).string() + "'";
  } else if constexpr (std::is_enum_v<Value>) {
    return std::to_string(int(value));
  } else if constexpr (std::is_arithmetic_v<Value>) {
    return fmt::format("{}", value);
  } else {
    return "{" + std::apply([](const auto&... fields) { return ((" " + textOf(fields)) + ...); }, fieldsOf(value)) + " }";
  }
}

}  // namespace cloudbake
