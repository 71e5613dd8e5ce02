// The functions in C++ of the Python module: arrays, texts and bytes go in, arrays, bytes and JSON come out. python/cloudbake/__init__.py
// calls them and makes Python's own types of what they return.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <future>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "core/error.h"
#include "core/lobe_lighting.h"
#include "core/parallel.h"
#include "core/text/markup.h"
#include "io/file/write_file.h"
#include "io/gltf/asset_info.h"
#include "pipeline/check/check.h"
#include "pipeline/library/cloudbake.h"
#include "pipeline/library/stage_plan.h"
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

// The work of all calls. A call that ends by Ctrl-C leaves work behind that comes to its end by itself; the process must not end under it.
// Nor must Python end under a call on another thread, for it would end that thread where it waits for Python's lock, in the middle of C++.
class Works {
 public:
  // Returns whether there may be new calls.
  bool enter() {
    const std::lock_guard lock(mutex_);
    if (!has_ended_) ++calls_;
    return !has_ended_;
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    --calls_;
    changed_.notify_all();
  }
  void add(LoopStop* stop) {
    const std::lock_guard lock(mutex_);
    stops_.insert(stop);
    ++threads_;
  }
  void remove(LoopStop* stop) {
    const std::lock_guard lock(mutex_);
    stops_.erase(stop);
  }
  // A thread has given up all that it had of Python.
  void end() {
    const std::lock_guard lock(mutex_);
    --threads_;
    changed_.notify_all();
  }
  size_t count() {
    const std::lock_guard lock(mutex_);
    return threads_;
  }
  void stopAll() {
    std::unique_lock lock(mutex_);
    has_ended_ = true;
    for (LoopStop* stop : stops_) stop->request();
    changed_.wait(lock, [this] { return threads_ == 0 && calls_ <= 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<LoopStop*> stops_;
  size_t threads_ = 0;
  int calls_ = 0;  // of threads of Python that wait; under 0 after a fork in a call
  bool has_ended_ = false;
};

// It outlives all threads, so it is never destroyed. A child of fork has none of the threads.
Works*& works() {
  static Works* all = [] {
    pthread_atfork(nullptr, nullptr, [] { works() = new Works; });
    return new Works;
  }();
  return all;
}

// At the end of the process. A second Ctrl-C ends it at once.
void stopAllWork() {
  if (works()->count() > 0) std::signal(SIGINT, SIG_DFL);
  const py::gil_scoped_release released;
  works()->stopAll();
}

// The process ends while a thread of Python still calls.
[[noreturn]] void endThread() {
  PyErr_SetNone(PyExc_SystemExit);
  throw py::error_already_set();
}

// While a thread of Python is in a call.
class Call {
 public:
  Call() {
    if (!works()->enter()) endThread();
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  ~Call() { works()->leave(); }
};

// What Python is told of the progress of one call.
class ProgressTeller {
 public:
  explicit ProgressTeller(py::object callable) : callable_(std::move(callable)) {}
  // Calls it if something changed; with Python's lock.
  void tell(int done, const char* stage) {
    if (callable_.is_none() || (done == done_ && std::strcmp(stage, stage_) == 0)) return;
    done_ = done, stage_ = stage;
    callable_(done, kTotal, stage);
  }
  void tell(const LoopProgress& progress) {
    tell(std::clamp(int(progress.share() * kTotal), std::max(done_, 0), kTotal - 1), progress.stage());
  }
  void tellEnd() { tell(kTotal, "done"); }

 private:
  static constexpr int kTotal = 1000;
  py::object callable_;
  int done_ = -1;
  const char* stage_ = "";
};

// Works on a thread of its own and without Python's lock, so that other threads of Python go on. Meanwhile this thread tells the progress
// and looks for signals. What their handlers raise (Ctrl-C: KeyboardInterrupt), or what `progress` raises, stops the work: its loops end
// soon, and this thread does not wait for them. So the work owns all that it uses.
template <class Work>
auto apart(Work work, py::object progress) {
  struct Job {
    explicit Job(Work&& given) : work(std::move(given)) {}
    Work work;
    LoopStop stop;
    LoopProgress progress;
  };
  const Call call;
  auto job = std::make_shared<Job>(std::move(work));
  ProgressTeller teller(std::move(progress));
  teller.tell(0, "begin");
  std::packaged_task<decltype(job->work())()> task([job] {
    const LoopStop::Scope stopped(job->stop);
    const LoopProgress::Scope counted(job->progress);
    return job->work();
  });
  auto done = task.get_future();
  works()->add(&job->stop);
  std::thread([job, task = std::move(task), all = works()]() mutable {
    task();
    task = {};
    all->remove(&job->stop);
    job.reset();
    all->end();
  }).detach();
  for (bool is_ready = false; !is_ready;) {
    {
      const py::gil_scoped_release released;
      is_ready = done.wait_for(std::chrono::milliseconds(20)) == std::future_status::ready;
    }
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!is_ready) teller.tell(job->progress);
    } catch (...) {
      job->stop.request();
      throw;
    }
  }
  try {
    auto result = done.get();
    teller.tellEnd();
    return result;
  } catch (const LoopStopped&) {
    endThread();
  }
}

// Keeps bytes of Python for work without Python's lock.
std::shared_ptr<py::bytes> keptBytes(py::bytes bytes) {
  return {new py::bytes(std::move(bytes)), [](py::bytes* kept) {
            const py::gil_scoped_acquire acquired;
            delete kept;
          }};
}

// Points, triangles and normals (no rows: none), as contiguous arrays of the right shape.
py::dict bakeMesh(const py::array_t<float>& positions, const py::array_t<uint32_t>& triangles, const py::array_t<float>& normals,
                  const Options& options, const py::object& progress) {
  SurfaceMesh mesh{rowsOf<Vec3>(positions), rowsOf<Vec3>(normals), rowsOf<Triangle>(triangles)};
  return resultOf(apart([mesh = std::move(mesh), options]() mutable { return bake(std::move(mesh), options); }, progress));
}

py::dict bakeFile(const std::string& file, const Options& options, const py::object& progress) {
  return resultOf(apart([file, options] { return bake(std::filesystem::path(file), options); }, progress));
}

py::dict growCall(const std::string& preset_or_file, const Options& options, const py::object& progress) {
  return resultOf(apart([preset_or_file, options] { return grow(preset_or_file, options); }, progress));
}

py::str checkCall(const std::string& file, const Options& options, const py::object& progress) {
  return textOf(apart(
      [file, options] {
        std::vector<Given> given;
        for (const auto& [name, value] : options) given.push_back({findOption(name, kCheck), value, "", 0, 0});
        const Settings settings = resolve(sourceOfFile(file), given);
        const ThreadLimit limit(settings.run.threads);
        StagePlan plan = StagePlan::ofCheck(settings);
        const CheckReport report = checkAsset(settings, [&](const std::string& stage) {
          throwIfLoopsStop();
          plan.end(stage);
        });
        enforceStrict(settings.run.strict, report.run);
        return checkJson(report);
      },
      progress));
}

// `name` is the file that the bytes come from, or a name for messages.
py::dict readCall(std::optional<py::bytes> bytes, const std::string& name) {
  const std::shared_ptr<py::bytes> kept = bytes ? keptBytes(std::move(*bytes)) : nullptr;
  const std::string_view given = kept ? std::string_view(*kept) : std::string_view();
  BakedMesh asset = apart([kept, given, name] { return kept ? readAsset(given, name) : readAsset(readFileBytes(name), name); }, py::none());
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

void writeCall(const std::string& file, const py::bytes& bytes) {
  const std::string_view glb(bytes);
  const py::gil_scoped_release released;
  if (!glb.starts_with("glTF")) throw UsageError("these bytes are not a GLB: write a bake or its .glb");
  refuseOtherFormat({file, "the file to write"}, ".glb");
  writeFileAtomically(file, glb);
}

// --- Light ---

// Both arrays have the same shape but for their last axis: 4 floats of a lobe, and 3 of a unit vector. Their strides may be 0.
py::array_t<float> transmittance(const py::array_t<float>& lobes, const py::array_t<float>& to_light, float exponent, float bias,
                                 float extinction) {
  constexpr py::ssize_t kBetweenSignals = 1 << 20, kGrain = 1 << 12;
  const py::ssize_t axes = lobes.ndim() - 1;
  const std::vector<py::ssize_t> shape(lobes.shape(), lobes.shape() + axes);
  py::array_t<float> result(shape);
  float* out = result.mutable_data();
  const auto *lobe_bytes = reinterpret_cast<const char*>(lobes.data()), *light_bytes = reinterpret_cast<const char*>(to_light.data());
  const std::vector<py::ssize_t> lobe_strides(lobes.strides(), lobes.strides() + axes + 1),
      light_strides(to_light.strides(), to_light.strides() + axes + 1);
  const auto vectorAt = [&](const char* at, py::ssize_t stride, float* values, int count) {
    for (int i = 0; i < count; ++i) std::memcpy(values + i, at + i * stride, sizeof(float));
  };
  const auto evaluate = [&](py::ssize_t i) {
    const char *lobe_at = lobe_bytes, *light_at = light_bytes;
    for (py::ssize_t axis = axes, left = i; axis-- > 0;) {
      const py::ssize_t index = left % shape[size_t(axis)];
      left /= shape[size_t(axis)];
      lobe_at += index * lobe_strides[size_t(axis)], light_at += index * light_strides[size_t(axis)];
    }
    float l[4], v[3];
    vectorAt(lobe_at, lobe_strides.back(), l, 4);
    vectorAt(light_at, light_strides.back(), v, 3);
    out[i] = lobeTransmittance({{l[0], l[1], l[2]}, l[3]}, {v[0], v[1], v[2]}, {exponent, bias}, extinction);
  };
  for (py::ssize_t first = 0; first < result.size(); first += kBetweenSignals) {
    {
      const py::gil_scoped_release released;
      parallelBlocks(first, std::min(first + kBetweenSignals, result.size()), size_t(kGrain), [&](py::ssize_t begin, py::ssize_t end) {
        for (py::ssize_t i = begin; i < end; ++i) evaluate(i);
      });
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
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
  py::module_::import("atexit").attr("register")(py::cpp_function(stopAllWork));
  module.def("bake_mesh", bakeMesh);
  module.def("bake_file", bakeFile);
  module.def("grow", growCall);
  module.def("check", checkCall);
  module.def("read", readCall);
  module.def("write", writeCall);
  module.def("transmittance", transmittance);
  module.def("options", optionsOf);
  module.def("presets", presetsOf);
  module.def("calls_at_work", [] { return works()->count(); });  // those that were stopped, but have not come to their end, too
}
