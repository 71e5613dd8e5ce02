// The functions in C++ of the Python module: arrays, texts and bytes go in, arrays, bytes and JSON come out. python/cloudbake/__init__.py
// calls them and makes Python's own types of what they return.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <cstring>
#include <future>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/lobe_lighting.h"
#include "core/parallel.h"
#include "core/text/markup.h"
#include "io/file/write_file.h"
#include "io/gltf/asset_info.h"
#include "pipeline/check/check.h"
#include "pipeline/library/cloudbake.h"
#include "pipeline/options/option_json.h"
#include "pipeline/options/presets.h"
#include "pipeline/options/resolve.h"
#include "pipeline/options/run_files.h"

namespace py = pybind11;

namespace cloudbake {

namespace {

// --- What goes in and comes out ---

// File names and texts of files may hold any bytes.
py::str textOf(const std::string& bytes) {
  return py::reinterpret_steal<py::str>(PyUnicode_DecodeUTF8(bytes.data(), py::ssize_t(bytes.size()), "replace"));
}
py::str nameOf(const std::string& bytes) {
  return py::reinterpret_steal<py::str>(PyUnicode_DecodeFSDefaultAndSize(bytes.data(), py::ssize_t(bytes.size())));
}

// An array that keeps the vector: #values × width numbers, or those of `width` columns of a flat vector.
template <class Number, class Value>
py::array arrayOf(std::vector<Value> values, size_t width = sizeof(Value) / sizeof(Number)) {
  auto* kept = new std::vector<Value>(std::move(values));
  const py::capsule owner(kept, [](void* vector) { delete static_cast<std::vector<Value>*>(vector); });
  const size_t rows = kept->size() * sizeof(Value) / sizeof(Number) / width;
  return py::array_t<Number>({rows, width}, reinterpret_cast<const Number*>(kept->data()), owner);
}
static_assert(sizeof(Lobe) == 4 * sizeof(float) && sizeof(Vec3) == 3 * sizeof(float));

template <class Value, class Number>
std::vector<Value> rowsOf(const py::array_t<Number>& array) {
  std::vector<Value> rows(size_t(array.shape(0)));
  std::memcpy(static_cast<void*>(rows.data()), array.data(), rows.size() * sizeof(Value));
  return rows;
}

py::dict constantsOf(const AssetInfo& info) {
  using namespace py::literals;
  return py::dict("exponent"_a = shortest(info.shape.exponent), "bias"_a = shortest(info.shape.bias),
                  "extinction"_a = shortest(info.extinction), "info"_a = textOf(writeInfo(info).dump()));
}

py::dict resultOf(BakeResult baked) {
  py::dict result = constantsOf(baked.info);
  result["lobes"] = arrayOf<float>(std::move(baked.lobes));
  result["glb"] = py::bytes(baked.glb);
  py::list warnings;
  for (const BakeWarning& warning : baked.warnings) warnings.append(py::make_tuple(warning.kind, warning.count, textOf(warning.first)));
  result["warnings"] = warnings;
  result["report"] = textOf(baked.report);
  result["summary"] = textOf(onOwnLines(baked.summary));
  return result;
}

// --- Errors ---

void raise(const Error& error) {
  const char* kind = error.code == ExitCode::kUsage    ? "UsageError"
                     : error.code == ExitCode::kInput  ? "InputError"
                     : error.code == ExitCode::kSystem ? "IoError"
                                                       : "Error";
  const py::object type = py::module_::import("cloudbake.errors").attr(kind);
  const py::object raised =
      type(textOf(onOneLine(error.message)), nameOf(error.file), error.line, error.column, static_cast<int>(error.code));
  PyErr_SetObject(type.ptr(), raised.ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const Error& error) {
    raise(error);
  } catch (const std::filesystem::filesystem_error& error) {
    raise(IoError(error.path1().string(), error.code().message() + "; check the path and its permissions"));
  }
}

// --- Work ---

// Works on a thread of its own and without Python's lock, so that other threads of Python go on. Meanwhile this thread looks for signals:
// what their handlers raise (Ctrl-C: KeyboardInterrupt) stops the work.
template <class Work>
auto apart(const Work& work) {
  const py::gil_scoped_release released;
  LoopStop stop;
  auto done = std::async(std::launch::async, [&] {
    const LoopStop::Scope scope(stop);
    return work([&stop](const std::string&) { stop.throwIfRequested(); });
  });
  while (done.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
    const py::gil_scoped_acquire acquired;
    if (PyErr_CheckSignals() == 0) continue;
    const py::error_already_set raised;
    stop.request();
    {
      const py::gil_scoped_release released_again;
      done.wait();
    }
    throw raised;
  }
  return done.get();
}

// Points, triangles and normals (no rows: none), as contiguous arrays of the right shape.
py::dict bakeMesh(const py::array_t<float>& positions, const py::array_t<uint32_t>& triangles, const py::array_t<float>& normals,
                  const Options& options) {
  const SurfaceMesh mesh{rowsOf<Vec3>(positions), rowsOf<Vec3>(normals), rowsOf<Triangle>(triangles)};
  return resultOf(apart([&](const StageListener& on_stage) { return bake(mesh, options, on_stage); }));
}

py::dict bakeFile(const std::string& file, const Options& options) {
  return resultOf(apart([&](const StageListener& on_stage) { return bake(std::filesystem::path(file), options, on_stage); }));
}

py::dict growCall(const std::string& preset_or_file, const Options& options) {
  return resultOf(apart([&](const StageListener& on_stage) { return grow(preset_or_file, options, on_stage); }));
}

py::str checkCall(const std::string& file, const Options& options) {
  return textOf(apart([&](const StageListener&) {
    std::vector<Given> given;
    for (const auto& [name, value] : options) given.push_back({findOption(name, kCheck), value, "", 0, 0});
    const Settings settings = resolve(sourceOfFile(file), given);
    const ThreadLimit limit(settings.run.threads);
    const CheckReport report = checkAsset(settings);
    enforceStrict(settings.run.strict, report.run);
    return checkJson(report);
  }));
}

// `name` is the file that the bytes come from, or a name for messages.
py::dict readCall(const std::optional<std::string>& bytes, const std::string& name) {
  BakedMesh asset = apart([&](const StageListener&) { return readAsset(bytes ? *bytes : readFileBytes(name), name); });
  py::dict result = constantsOf(asset.info);
  result["positions"] = arrayOf<float>(std::move(asset.surface.positions));
  result["normals"] = arrayOf<float>(std::move(asset.surface.normals));
  result["triangles"] = arrayOf<uint32_t>(std::move(asset.surface.triangles));
  result["lobes"] = arrayOf<float>(std::move(asset.lobes));
  result["harmonics"] = py::none();
  if (asset.info.harmonic_order > 0) {
    const size_t degrees = size_t(asset.info.harmonic_order) + 1;
    result["harmonics"] = arrayOf<float>(std::move(asset.harmonics), degrees * degrees);
  }
  return result;
}

void writeCall(const std::string& file, const std::string& glb) {
  const py::gil_scoped_release released;
  if (!glb.starts_with("glTF")) throw UsageError("these bytes are not a GLB: write a bake or its .glb");
  refuseOtherFormat({file, "the file to write"}, ".glb");
  writeFileAtomically(file, glb);
}

// --- Light ---

// Both arrays have the same shape but for their last axis: 4 floats of a lobe, and 3 of a unit vector. Their strides may be 0.
py::array_t<float> transmittance(const py::array_t<float>& lobes, const py::array_t<float>& to_light, float exponent, float bias,
                                 float extinction) {
  const size_t axes = size_t(lobes.ndim()) - 1;
  const std::vector<py::ssize_t> shape(lobes.shape(), lobes.shape() + axes);
  py::array_t<float> result(shape);
  float* out = result.mutable_data();
  const auto vectorAt = [](const py::array_t<float>& array, const char* at, float* values, int count) {
    for (int i = 0; i < count; ++i) std::memcpy(values + i, at + i * array.strides(array.ndim() - 1), sizeof(float));
  };
  const char *lobe_at = reinterpret_cast<const char*>(lobes.data()), *light_at = reinterpret_cast<const char*>(to_light.data());
  const py::gil_scoped_release released;
  std::vector<py::ssize_t> index(axes, 0);
  for (py::ssize_t left = result.size(); left > 0; --left) {
    float l[4], v[3];
    vectorAt(lobes, lobe_at, l, 4);
    vectorAt(to_light, light_at, v, 3);
    *out++ = lobeTransmittance({{l[0], l[1], l[2]}, l[3]}, {v[0], v[1], v[2]}, {exponent, bias}, extinction);
    // The next place, the last axis first.
    for (size_t axis = axes; axis-- > 0;) {
      const bool wraps = ++index[axis] == shape[axis];
      const py::ssize_t steps = wraps ? 1 - shape[axis] : 1;
      lobe_at += steps * lobes.strides(py::ssize_t(axis)), light_at += steps * to_light.strides(py::ssize_t(axis));
      if (!wraps) break;
      index[axis] = 0;
    }
  }
  return result;
}

// --- The table of options ---

// Whether a function takes an option: files are for the command line, and so is what only makes sense with them.
bool isOffered(const Option& option, Command command, bool for_mesh) {
  if (!(option.commands & command) || (option.bits & kOfOutputFiles)) return false;
  if (for_mesh && ((option.bits & kOfInputFile) || !(option.inputs & kFromSculpt))) return false;
  return option.files.kind == FileUse::kNone || (command == kCheck && option.files.kind == FileUse::kRead);
}

// The options of "bake", "bake_file", "grow" or "check" in the order of the help, as JSON.
std::string optionsOf(const std::string& function) {
  const Command command = function == "grow" ? kGrow : function == "check" ? kCheck : kBake;
  Json options = Json::array();
  for (const Option& option : optionTable()) {
    if (!isOffered(option, command, function == "bake")) continue;
    options.push_back(optionJson(option, command));
    options.back()["is_file"] = option.files.kind != FileUse::kNone;
  }
  return options.dump();
}

py::list presetsOf() {
  py::list names;
  for (const Preset& preset : presets()) names.append(preset.name);
  return names;
}

}  // namespace

}  // namespace cloudbake

PYBIND11_MODULE(_cloudbake, module) {
  using namespace cloudbake;
  py::register_exception_translator(translate);
  module.attr("version") = version();
  module.def("bake_mesh", bakeMesh);
  module.def("bake_file", bakeFile);
  module.def("grow", growCall);
  module.def("check", checkCall);
  module.def("read", readCall);
  module.def("write", writeCall);
  module.def("transmittance", transmittance);
  module.def("options", optionsOf);
  module.def("presets", presetsOf);
}
