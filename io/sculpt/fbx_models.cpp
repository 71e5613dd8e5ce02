// FBX is a tree of elements, each a name, values and children. In the binary form (Blender, "FBX binary file format specification", 2013)
// an element begins with the offset of its end, the number of its values, their bytes and its name: 32-bit numbers before version 7500,
// 64-bit numbers from there on; an element of zeros ends a list of children. In the text form it is  Name: value, value { children }.
// Elements that are not needed, such as meshes, are passed over unread.
#include "io/sculpt/fbx_models.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <unordered_map>

#include "core/error.h"
#include "core/little_endian.h"
#include "core/text/scan.h"

namespace cloudbake {

namespace {

constexpr size_t kMostValues = 8;  // no element that is needed has more

struct FbxValue {
  std::string_view text;  // of a text or, in the text form, as written
  double number = 0;
  uint64_t id = 0;
};

uint64_t idOf(std::string_view written) {
  uint64_t id = 0;
  int64_t negative = 0;
  if (written.starts_with('-'))
    std::from_chars(written.data(), written.data() + written.size(), negative), id = uint64_t(negative);
  else
    std::from_chars(written.data(), written.data() + written.size(), id);
  return id;
}

// Takes the elements in the order of the file, and chooses which of them are read.
class ModelCollector {
 public:
  // An element `depth` levels below the top. Returns whether its children are wanted.
  bool enter(size_t depth, std::string_view name, const std::vector<FbxValue>& values) {
    if (depth == 0) {
      section_ = name;
      return name == "GlobalSettings" || name == "Definitions" || name == "Objects" || name == "Connections";
    }
    if (section_ == "GlobalSettings") return properties(depth, 1, name, values, result_.settings);
    if (section_ == "Definitions") {
      if (depth == 1) return name == "ObjectType" && textOf(values, 0) == "Model";
      if (depth == 2) return name == "PropertyTemplate" && textOf(values, 0) == "FbxNode";
      return properties(depth, 3, name, values, template_);
    }
    if (section_ == "Objects") {
      if (depth == 1) return beginObject(name, values);
      return properties(depth, 2, name, values, is_layer_ ? layer_ : result_.models.back().properties);
    }
    if (depth == 1 && name == "C" && values.size() >= 3 && textOf(values, 0) != "PP" && textOf(values, 0) != "OP")
      links_.emplace_back(values[1].id, values[2].id);
    return false;
  }

  // An element whose children were wanted has ended.
  void leave(size_t depth) {
    if (section_ != "Objects" || depth != 1 || !is_layer_) return;
    const auto shown = layer_.find("Show");
    if (shown != layer_.end() && shown->second[0] == 0) objects_[object_].kind = Object::kHiddenLayer;
  }

  FbxModels result() {
    for (FbxModel& model : result_.models) model.properties.insert(template_.begin(), template_.end());
    for (const auto& [source, target] : links_) connect(source, target);
    return std::move(result_);
  }

 private:
  struct Object {
    enum Kind { kOther, kModel, kHiddenLayer } kind = kOther;
    size_t model = 0;
  };

  static std::string_view textOf(const std::vector<FbxValue>& values, size_t index) {
    return index < values.size() ? values[index].text : std::string_view();
  }

  // Properties70 at `level`, and its  P: "name", "type", "label", "flags", value, value, value  below. The last of a name counts.
  static bool properties(size_t depth, size_t level, std::string_view name, const std::vector<FbxValue>& values, FbxProperties& into) {
    if (depth == level) return name == "Properties70";
    if (depth != level + 1 || name != "P" || values.size() < 5) return false;
    std::array<double, 3> numbers{};
    for (size_t i = 0; i < 3 && i + 4 < values.size(); ++i) numbers[i] = values[i + 4].number;
    into.insert_or_assign(std::string(values[0].text), numbers);
    return false;
  }

  // Objects of a class that assimp does not make a node of are no models.
  bool beginObject(std::string_view type, const std::vector<FbxValue>& values) {
    if (values.empty()) return false;
    object_ = values[0].id;
    Object& object = objects_[object_] = {};
    is_layer_ = type == "CollectionExclusive";
    layer_.clear();
    if (type != "Model") return is_layer_;
    const std::string_view kind = textOf(values, 2);
    if (values.size() < 3 || kind == "IKEffector" || kind == "FKEffector") return false;
    object.kind = Object::kModel;
    object.model = result_.models.size();
    result_.models.emplace_back().name = nameOf(values[1].text);
    return true;
  }

  // "Model::name" in the text form, "name\0\1Model" in the binary form.
  static std::string nameOf(std::string_view written) {
    constexpr std::string_view kClass = "Model::", kSeparator("\0\1", 2);
    const size_t end = written.find(kSeparator);
    if (end == std::string_view::npos) return std::string(written.starts_with(kClass) ? written.substr(kClass.size()) : written);
    const std::string_view type = written.substr(end + 2), name = written.substr(0, end);
    return type == "Model" ? std::string(name) : std::string(type) + "::" + std::string(name);
  }

  void connect(uint64_t source, uint64_t target) {
    const auto from = objects_.find(source), to = objects_.find(target);
    if (from == objects_.end() || from->second.kind != Object::kModel) return;
    if (target == 0)
      result_.roots.push_back(from->second.model);
    else if (to != objects_.end() && to->second.kind == Object::kModel)
      result_.models[to->second.model].children.push_back(from->second.model);
    else if (to != objects_.end() && to->second.kind == Object::kHiddenLayer)
      result_.models[from->second.model].in_hidden_layer = true;
  }

  FbxModels result_;
  FbxProperties template_, layer_;
  std::string section_;
  uint64_t object_ = 0;
  bool is_layer_ = false;
  std::unordered_map<uint64_t, Object> objects_;
  std::vector<std::pair<uint64_t, uint64_t>> links_;
};

// --- the binary form ---

class BinaryReader {
 public:
  BinaryReader(const std::string& file, std::string_view bytes, ModelCollector& into) : file_(file), bytes_(bytes), into_(into) {}

  void read() {
    constexpr size_t kHeader_bytes = 27;
    if (bytes_.size() < kHeader_bytes) damaged(bytes_.size());
    is_wide_ = whole(23, 4) >= 7500;
    for (size_t at = kHeader_bytes; at < bytes_.size();) {
      const size_t end = readElement(at, bytes_.size(), 0);
      if (end == at) return;  // a footer follows
      at = end;
    }
  }

 private:
  [[noreturn]] void damaged(size_t at) const {
    throw InputError(file_, "the FBX is damaged at byte " + std::to_string(at) + "; export it again");
  }
  // The caller knows that it is there.
  uint64_t whole(size_t at, size_t size) const { return fromLittleEndian(bytes_.substr(at, size)); }

  // Returns the element's end, or `at` for the zeros that end a list. The collector wants five levels at most, so this is not deep.
  size_t readElement(size_t at, size_t limit, size_t depth) {
    const size_t word = is_wide_ ? 8 : 4, header = 3 * word + 1;
    if (limit - at < header) damaged(at);
    const uint64_t end = whole(at, word), value_count = whole(at + word, word), value_bytes = whole(at + 2 * word, word);
    const size_t name_at = at + header, name_size = uint8_t(bytes_[name_at - 1]);
    if (end == 0) return at;
    if (end > limit || end < name_at || end - name_at < name_size || end - name_at - name_size < value_bytes) damaged(at);
    const size_t values_at = name_at + name_size, children_at = values_at + size_t(value_bytes);
    readValues(values_at, children_at, value_count);
    if (!into_.enter(depth, bytes_.substr(name_at, name_size), values_)) return size_t(end);
    for (size_t child = children_at; child < end;) {
      const size_t next = readElement(child, size_t(end), depth + 1);
      if (next == child) break;
      child = next;
    }
    into_.leave(depth);
    return size_t(end);
  }

  void readValues(size_t at, size_t end, uint64_t count) {
    values_.clear();
    for (uint64_t i = 0; i < std::min<uint64_t>(count, kMostValues); ++i) at = readValue(at, end);
  }

  // Returns the end of the value. Arrays and raw bytes count as 0.
  size_t readValue(size_t at, size_t end) {
    if (at >= end) damaged(at);
    const char type = bytes_[at++];
    const auto need = [&](uint64_t size) {
      if (end - at < size) damaged(at);
    };
    FbxValue value;
    size_t size = 0;
    switch (type) {
      case 'B':
      case 'C':
      case 'Z': size = 1; break;
      case 'Y': size = 2; break;
      case 'I':
      case 'F': size = 4; break;
      case 'D':
      case 'L': size = 8; break;
      case 'S':
      case 'R':
        need(4), size = size_t(whole(at, 4)), at += 4, need(size);
        if (type == 'S') value.text = bytes_.substr(at, size);
        break;
      case 'b':
      case 'c':
      case 'd':
      case 'f':
      case 'i':
      case 'l': need(12), size = size_t(whole(at + 8, 4)), at += 12; break;
      default: damaged(at - 1);
    }
    need(size);
    if (type == 'F')
      value.number = std::bit_cast<float>(uint32_t(whole(at, 4)));
    else if (type == 'D')
      value.number = std::bit_cast<double>(whole(at, 8));
    else if (std::strchr("BCZYIL", type))
      value.id = signExtended(whole(at, size), size), value.number = double(int64_t(value.id));
    values_.push_back(value);
    return at + size;
  }
  static uint64_t signExtended(uint64_t value, size_t size) {
    const unsigned unused = unsigned(8 * (8 - size));
    return uint64_t(int64_t(value << unused) >> unused);
  }

  const std::string& file_;
  std::string_view bytes_;
  ModelCollector& into_;
  bool is_wide_ = false;
  std::vector<FbxValue> values_;
};

// --- the text form ---

class TextReader {
 public:
  TextReader(const std::string& file, std::string_view text, ModelCollector& into) : file_(file), text_(text), into_(into) {}

  void read() {
    size_t depth = 0;  // of the collector's elements: blocks that it does not want are passed over
    for (skipBlanks(true); at_ < text_.size(); skipBlanks(true)) {
      if (text_[at_] == '}') {
        if (depth == 0) damaged();
        ++at_;
        into_.leave(--depth);
        continue;
      }
      const std::string_view name = readName();
      readValues();
      skipBlanks(true);
      const bool has_block = at_ < text_.size() && text_[at_] == '{', wanted = into_.enter(depth, name, values_);
      if (!has_block) {
        if (wanted) into_.leave(depth);
      } else if (++at_; wanted) {
        ++depth;
      } else {
        skipBlock();
      }
    }
    if (depth > 0) damaged();
  }

 private:
  [[noreturn]] void damaged() const {
    const auto end = text_.begin() + std::ptrdiff_t(std::min(at_, text_.size()));
    throw InputError(file_, int(1 + std::count(text_.begin(), end, '\n')), "the FBX is damaged; export it again");
  }
  void skipLine() { at_ = std::min(text_.find('\n', at_), text_.size()); }
  void skipBlanks(bool lines) {
    while (at_ < text_.size() && (isBlank(text_[at_]) || text_[at_] == ';')) {
      if (!lines && (text_[at_] == '\n' || text_[at_] == ';')) return;
      if (text_[at_] == ';')
        skipLine();
      else
        ++at_;
    }
  }
  std::string_view quoted() {
    const size_t end = text_.find('"', at_ + 1);
    if (end == std::string_view::npos) damaged();
    const std::string_view inside = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return inside;
  }
  std::string_view word() {
    const size_t begin = at_;
    while (at_ < text_.size() && !isBlank(text_[at_]) && !std::strchr(",:;{}\"", text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  std::string_view readName() {
    const std::string_view name = word();
    skipBlanks(true);
    if (name.empty() || at_ >= text_.size() || text_[at_] != ':') damaged();
    ++at_;
    return name;
  }

  // A comma continues the list, in the next line too.
  void readValues() {
    values_.clear();
    for (skipBlanks(false); at_ < text_.size() && !std::strchr("\n;{}", text_[at_]); skipBlanks(false)) {
      FbxValue value;
      if (text_[at_] == '"') {
        value.text = quoted();
      } else {
        value.text = word();
        if (values_.size() < kMostValues) value.number = parseNumber(value.text).value_or(0), value.id = idOf(value.text);
      }
      if (values_.size() < kMostValues) values_.push_back(value);
      skipBlanks(false);
      if (at_ >= text_.size() || text_[at_] != ',') return;
      ++at_;
      skipBlanks(true);
    }
  }

  void skipBlock() {
    for (size_t open = 1; open > 0;) {
      at_ = text_.find_first_of("{}\";", at_);
      if (at_ == std::string_view::npos) damaged();
      if (text_[at_] == '"') {
        quoted();
      } else if (text_[at_] == ';') {
        skipLine();
      } else {
        open += text_[at_] == '{' ? 1 : size_t(-1);
        ++at_;
      }
    }
  }

  const std::string& file_;
  std::string_view text_;
  ModelCollector& into_;
  size_t at_ = 0;
  std::vector<FbxValue> values_;
};

}  // namespace

std::optional<double> FbxModel::number(std::string_view property) const {
  const auto found = properties.find(property);
  return found == properties.end() ? std::nullopt : std::optional(found->second[0]);
}

std::array<double, 3> FbxModel::vector(std::string_view property, double otherwise) const {
  const auto found = properties.find(property);
  return found == properties.end() ? std::array{otherwise, otherwise, otherwise} : found->second;
}

bool FbxModel::isHidden(bool parent_is_hidden, bool& inherited) const {
  const bool follows = number("Visibility Inheritance").value_or(1) != 0;
  inherited = number("Visibility").value_or(1) == 0 || in_hidden_layer || (parent_is_hidden && follows);
  return inherited || number("Show").value_or(1) == 0;
}

bool isBinaryFbx(std::string_view bytes) { return bytes.starts_with("Kaydara FBX Binary"); }

FbxModels readFbxModels(const std::string& file, std::string_view bytes) {
  ModelCollector collector;
  if (isBinaryFbx(bytes))
    BinaryReader(file, bytes, collector).read();
  else
    TextReader(file, bytes.substr(0, bytes.find('\0')), collector).read();
  return collector.result();
}

}  // namespace cloudbake
