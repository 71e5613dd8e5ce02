// Google Highway compiles this file once per target and picks one at run time; no FMA, 8 lanes at most. Each ray has the number j of its
// next sample. φ keeps its sign within 0.9 |φ| and within a block's cube (bake/field/dense_field.cpp), so closer samples count like the
// current one and are not read. Several vectors of rays are marched in turn, because one step is a chain that waits for memory and
// arithmetic longer than it computes. Rays end after different numbers of samples, so lanes whose ray has ended get the next rays.
#include "bake/lobe/march_kernels.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bake/lobe/march_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "bake/lobe/simd_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cloudbake {
namespace HWY_NAMESPACE {

using Mask = hn::Mask<Wide>;

// The bilinear value of the four corners of a cell's face, per ray.
HWY_INLINE V bilinear(const float* const* cells, int offset, V part_x, V part_y) {
  const auto face = [&](int n)
                        HWY_ATTR { return pairOfBlocks([&](int ray) HWY_ATTR { return hn::LoadU(Block(), cells[ray] + offset); }, n); };
  return bilinear(face(0), face(1), face(2), face(3), part_y, part_x);
}

struct Vectors {
  V x, y, z;
};

// Converts a whole number 0 … 2²² from float to an integer. After adding 2²³ the low bits of the float are the integer.
HWY_INLINE VInts toInt(V whole) {
  const hn::RebindToSigned<Wide> di;
  return hn::And(hn::BitCast(di, hn::Add(whole, hn::Set(Wide(), 8388608.0F))), hn::Set(di, 0x7FFFFF));
}

// Data shared by all rays of a march; `blocks` is per axis. Samples are at (j + shift)Δ. In a crossing march the samples j = 0 … S are the
// ends of the steps; otherwise each sample 0 … S − 1 is one step.
struct March {
  const float* values;
  const int32_t* offsets;
  const uint8_t* clearances;
  std::array<int, 3> bricks, blocks;
  int block_bits;
  bool crossing;
  float band, step, shift, last_sample;
};

struct Sample {
  V phi, clearance;  // in voxels; in blocks
};

// Stores eight integers to memory, because extracting lanes from a register takes longer.
struct Numbers {
  uint32_t at[8];
  HWY_INLINE explicit Numbers(VInts numbers) {
    hn::StoreU(numbers, WideInts(), reinterpret_cast<int32_t*>(at));
    asm("" : "+m"(at));
  }
};

// Reads eight bytes of a table and converts them to floats.
HWY_INLINE V lookUp(const uint8_t* table, VInts index) {
  const Wide d;
  const WideInts di;
  const Numbers numbers(index);
  uint64_t packed = 0;
  for (size_t n = 0; n < hn::Lanes(d); ++n) packed |= uint64_t(table[numbers.at[n]]) << (8 * n);
  return hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(hn::Rebind<uint8_t, Wide>(), reinterpret_cast<const uint8_t*>(&packed))));
}

// φ and clearance at lattice positions inside the box. `octant` is where the clearances of the ray's octant begin.
HWY_INLINE Sample sampleField(const March& march, const Vectors& at, VInts octant) {
  const Wide d;
  const WideInts di;
  constexpr int kBrickBits = 3;
  static_assert(DenseField::kBrick == 1 << kBrickBits);
  const V cell_x = hn::Floor(at.x), cell_y = hn::Floor(at.y), cell_z = hn::Floor(at.z);
  const VInts x = toInt(cell_x), y = toInt(cell_y), z = toInt(cell_z);
  const auto linear = [&](VInts i, VInts j, VInts k, const std::array<int, 3>& counts)
                          HWY_ATTR { return hn::Add(hn::Mul(hn::Add(hn::Mul(k, hn::Set(di, counts[1])), j), hn::Set(di, counts[0])), i); };
  const int bits = march.block_bits;
  const V clearance =
      lookUp(march.clearances,
             hn::Add(linear(hn::ShiftRightSame(x, bits), hn::ShiftRightSame(y, bits), hn::ShiftRightSame(z, bits), march.blocks), octant));

  const Numbers bricks(linear(hn::ShiftRight<kBrickBits>(x), hn::ShiftRight<kBrickBits>(y), hn::ShiftRight<kBrickBits>(z), march.bricks));
  const VInts in_brick = hn::Set(di, DenseField::kBrick - 1);
  const VInts plane = hn::Mul(hn::And(z, in_brick), hn::Set(di, DenseField::kPlane)),
              row = hn::Mul(hn::And(y, in_brick), hn::Set(di, DenseField::kRow));
  const Numbers corners(hn::Add(hn::Add(plane, row), hn::ShiftLeft<1>(hn::And(x, in_brick))));
  const float* cells[8];
  for (size_t n = 0; n < hn::Lanes(d); ++n) cells[n] = march.values + (uint32_t(march.offsets[bricks.at[n]]) + corners.at[n]);

  const V part_x = hn::Sub(at.x, cell_x), part_y = hn::Sub(at.y, cell_y), part_z = hn::Sub(at.z, cell_z);
  const V below = bilinear(cells, 0, part_x, part_y), above = bilinear(cells, DenseField::kPlane, part_x, part_y);
  return {lerp(below, above, part_z), clearance};
}

// Samples keep this distance to the border of the box, so that rounding cannot move them out of it.
constexpr float kMargin = 0.5F;

// The numbers of the first and the last sample inside the box, per ray.
struct SampleRange {
  V first, last;
};
HWY_INLINE SampleRange samplesInBox(const March& march, const Vectors& origin, const Vectors& inverse, V per_step, V shift, V last) {
  const Wide d;
  V enter = hn::Zero(d), leave = hn::Set(d, INFINITY);
  const auto clip = [&](V p, V inverse_direction, int bricks) HWY_ATTR {
    const V low = hn::Mul(hn::Sub(hn::Set(d, kMargin), p), inverse_direction);
    const V high = hn::Mul(hn::Sub(hn::Set(d, float(bricks * DenseField::kBrick) - kMargin), p), inverse_direction);
    enter = hn::Max(enter, hn::Min(low, high));
    leave = hn::Min(leave, hn::Max(low, high));
  };
  clip(origin.x, inverse.x, march.bricks[0]);
  clip(origin.y, inverse.y, march.bricks[1]);
  clip(origin.z, inverse.z, march.bricks[2]);
  return {hn::Max(hn::Ceil(hn::Sub(hn::Mul(enter, per_step), shift)), hn::Zero(d)),
          hn::Min(hn::Floor(hn::Sub(hn::Mul(leave, per_step), shift)), last)};
}

constexpr size_t kTogether = 3;
constexpr size_t kEnded =
    2;  // lanes of a vector that wait for new rays at once, because a change of rays costs as much as a third of a step

// A vector of rays that are being marched.
struct Marching {
  Vectors origin, direction;
  V j, last, inside_steps, before;
  VInts octant;   // where the clearances of the ray's octant begin
  V block_steps;  // number of steps along one block
};

// φ at the origins of rays. Consecutive rays often have the same origins, so it is kept.
struct Origins {
  Vectors at;
  V phi;
};
HWY_INLINE void moveOrigins(const March& march, const Vectors& at, Origins& origins) {
  const Wide d;
  const Mask same = hn::And(hn::And(hn::Eq(at.x, origins.at.x), hn::Eq(at.y, origins.at.y)), hn::Eq(at.z, origins.at.z));
  if (hn::AllTrue(d, same)) return;
  const auto inBox = [&](V p, int bricks) HWY_ATTR {
    return hn::Max(hn::Min(p, hn::Set(d, float(bricks * DenseField::kBrick) - kMargin)), hn::Set(d, kMargin));
  };
  origins = {at, sampleField(march, {inBox(at.x, march.bricks[0]), inBox(at.y, march.bricks[1]), inBox(at.z, march.bricks[2])},
                             hn::Zero(WideInts()))
                     .phi};
}

HWY_INLINE void startRays(const March& march, const RayArrays& rays, size_t i, Origins& origins, Marching& started) {
  const Wide d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F), tiny = hn::Set(d, 1e-20F);
  const auto inverted = [&](V x) HWY_ATTR { return hn::Div(one, hn::IfThenElse(hn::Lt(hn::Abs(x), tiny), hn::CopySign(tiny, x), x)); };
  const Vectors origin{hn::LoadU(d, rays.origin[0] + i), hn::LoadU(d, rays.origin[1] + i), hn::LoadU(d, rays.origin[2] + i)};
  const Vectors direction{hn::LoadU(d, rays.direction[0] + i), hn::LoadU(d, rays.direction[1] + i), hn::LoadU(d, rays.direction[2] + i)};
  const Vectors inverse{inverted(direction.x), inverted(direction.y), inverted(direction.z)};
  const auto [first, last] =
      samplesInBox(march, origin, inverse, hn::Set(d, 1 / march.step), hn::Set(d, march.shift), hn::Set(d, march.last_sample));
  const auto bit = [&](V x, int value)
                       HWY_ATTR { return hn::IfThenElseZero(hn::RebindMask(WideInts(), hn::Lt(x, zero)), hn::Set(WideInts(), value)); };
  const int blocks = march.blocks[0] * march.blocks[1] * march.blocks[2];
  const VInts octant = hn::Add(hn::Add(bit(direction.x, blocks), bit(direction.y, 2 * blocks)), bit(direction.z, 4 * blocks));
  const V along = hn::Min(hn::Min(hn::Abs(inverse.x), hn::Abs(inverse.y)), hn::Abs(inverse.z));
  const V block_steps = hn::Mul(along, hn::Set(d, 0.9999F * float(1 << march.block_bits) / march.step));
  // A crossing march begins with the step between the samples 0 and 1, unless the ray enters the box from outside.
  V begun = first, before = hn::Set(d, march.band);
  if (march.crossing) {
    moveOrigins(march, origin, origins);
    begun = hn::Max(first, one);
    before = hn::IfThenElse(hn::Eq(first, zero), hn::Max(hn::Min(origins.phi, before), hn::Neg(before)), before);
  }
  // A ray that misses the box is kept at a safe place.
  const Mask misses = hn::Gt(first, last);
  const auto kept = [&](V x, V in_place) HWY_ATTR { return hn::IfThenElse(misses, in_place, x); };
  started.origin.x = kept(origin.x, one), started.origin.y = kept(origin.y, one), started.origin.z = kept(origin.z, one);
  started.direction.x = kept(direction.x, zero), started.direction.y = kept(direction.y, zero),
  started.direction.z = kept(direction.z, zero);
  started.j = begun, started.last = last, started.inside_steps = zero, started.before = before;
  started.octant = octant, started.block_steps = block_steps;
}

HWY_INLINE void advance(const March& march, Marching& rays, Mask live) {
  const Wide d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F), band = hn::Set(d, march.band);
  const V t = hn::Mul(hn::Add(hn::Min(rays.j, rays.last), hn::Set(d, march.shift)), hn::Set(d, march.step));
  const auto [phi, clearance] =
      sampleField(march,
                  {hn::Add(rays.origin.x, hn::Mul(rays.direction.x, t)), hn::Add(rays.origin.y, hn::Mul(rays.direction.y, t)),
                   hn::Add(rays.origin.z, hn::Mul(rays.direction.z, t))},
                  rays.octant);

  // The step that this sample ends.
  const V clipped = hn::Max(hn::Min(phi, band), hn::Neg(band));
  const Mask is_inside = hn::Lt(clipped, zero), was_inside = hn::Lt(rays.before, zero);
  V part = hn::IfThenElseZero(is_inside, one);
  if (march.crossing) {
    const V fraction = hn::Div(rays.before, hn::Sub(rays.before, clipped));
    part = hn::IfThenElse(hn::Xor(is_inside, was_inside), hn::IfThenElse(was_inside, fraction, hn::Sub(one, fraction)), part);
  }
  const V ended = hn::IfThenElseZero(live, part);

  // Skip to the last sample that keeps the sign, or go to the next sample. The skipped samples are whole steps.
  const V safe = hn::Floor(hn::Max(hn::Mul(hn::Abs(phi), hn::Set(d, 0.9F / march.step)), hn::Mul(clearance, rays.block_steps)));
  const V skipped = hn::IfThenElseZero(live, hn::Max(hn::Min(hn::Sub(safe, one), hn::Sub(rays.last, rays.j)), zero));
  rays.inside_steps = hn::Add(rays.inside_steps, hn::Add(ended, hn::IfThenElseZero(is_inside, skipped)));
  rays.before = hn::IfThenElse(live, clipped, rays.before);
  rays.j = hn::Add(rays.j, hn::Add(skipped, one));
}

// The inside length in steps. Everything beyond the box is outside. In a crossing march the step that leaves the box may begin inside.
HWY_INLINE V insideSteps(const March& march, const Marching& rays) {
  const Wide d;
  if (!march.crossing) return rays.inside_steps;
  const Mask leaves_inside = hn::And(hn::Lt(rays.before, hn::Zero(d)), hn::Lt(rays.last, hn::Set(d, march.last_sample)));
  return hn::Add(rays.inside_steps, hn::IfThenElseZero(leaves_inside, hn::Div(rays.before, hn::Sub(rays.before, hn::Set(d, march.band)))));
}

// The fields of Marching as arrays, in their order, so that lanes can be replaced.
constexpr size_t kJ = 6, kLast = 7, kInsideSteps = 8, kBefore = 9, kOctant = 10, kBlockSteps = 11, kFields = 12;
struct alignas(32) Fields {
  float at[kFields][8];
};
HWY_INLINE Marching load(const Fields& fields) {
  const Wide d;
  const auto field = [&](size_t n) HWY_ATTR { return hn::Load(d, fields.at[n]); };
  return {{field(0), field(1), field(2)},
          {field(3), field(4), field(5)},
          field(kJ),
          field(kLast),
          field(kInsideSteps),
          field(kBefore),
          hn::BitCast(WideInts(), field(kOctant)),
          field(kBlockSteps)};
}
HWY_INLINE void storeMoved(const Marching& rays, Fields& fields) {
  const Wide d;
  hn::Store(rays.j, d, fields.at[kJ]), hn::Store(rays.inside_steps, d, fields.at[kInsideSteps]),
      hn::Store(rays.before, d, fields.at[kBefore]);
}
HWY_INLINE void store(const Marching& rays, Fields& fields) {
  const Wide d;
  const V values[kFields] = {rays.origin.x,
                             rays.origin.y,
                             rays.origin.z,
                             rays.direction.x,
                             rays.direction.y,
                             rays.direction.z,
                             rays.j,
                             rays.last,
                             rays.inside_steps,
                             rays.before,
                             hn::BitCast(d, rays.octant),
                             rays.block_steps};
  for (size_t n = 0; n < kFields; ++n) hn::Store(values[n], d, fields.at[n]);
}

// The rays that are still to be marched, started a vector at a time.
struct StartedRays {
  const March& march;
  const RayArrays& rays;
  Origins origins{{hn::Set(Wide(), -INFINITY), hn::Set(Wide(), -INFINITY), hn::Set(Wide(), -INFINITY)}, hn::Zero(Wide())};
  Fields fields;
  size_t next = 0;  // the number of the next ray

  HWY_INLINE StartedRays(const March& of_march, const RayArrays& of_rays) : march(of_march), rays(of_rays) {}
  HWY_INLINE bool empty() const { return next == rays.count; }
  // Moves the next ray to a lane, and returns its number.
  HWY_INLINE uint32_t moveTo(Fields& target, size_t lane) {
    const size_t from = next % hn::Lanes(Wide());
    if (from == 0) {
      Marching started;
      startRays(march, rays, next, origins, started);
      store(started, fields);
    }
    for (size_t n = 0; n < kFields; ++n) target.at[n][lane] = fields.at[n][from];
    return uint32_t(next++);
  }
};

constexpr uint32_t kNoRay = UINT32_MAX;

// A vector of rays, and their numbers.
struct LaneRays {
  Fields fields{};
  uint32_t ray[8];
  size_t count = 0;  // lanes that have a ray

  HWY_INLINE LaneRays() {
    for (uint32_t& number : ray) number = kNoRay;
    for (float& last : fields.at[kLast]) last = -1;  // its first sample is beyond the last: it has ended
  }

  // Writes the lengths of rays that have ended, and puts new ones in their lanes.
  HWY_INLINE void replaceEnded(const March& march, const Marching& marching, StartedRays& started, float* lengths) {
    const Wide d;
    alignas(32) float found[8];
    hn::Store(hn::Mul(insideSteps(march, marching), hn::Set(d, march.step)), d, found);
    for (size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      if (fields.at[kJ][lane] <= fields.at[kLast][lane]) continue;
      if (ray[lane] != kNoRay) lengths[ray[lane]] = found[lane], --count;
      ray[lane] = kNoRay;
      if (started.empty()) continue;  // it stays at its last sample
      ray[lane] = started.moveTo(fields, lane);
      ++count;
    }
  }
};

void MarchRays(const DenseField& field, const RayArrays& rays, const MarchSettings& settings, float* lengths) {
  const Wide d;
  const bool crossing = settings.quadrature == Quadrature::kCrossing;
  const int blocks = DenseField::kBrick >> field.block_bits;
  const March march{field.values.data(),
                    field.offsets.data(),
                    field.clearances.data(),
                    field.bricks,
                    {field.bricks[0] * blocks, field.bricks[1] * blocks, field.bricks[2] * blocks},
                    field.block_bits,
                    crossing,
                    field.band,
                    settings.length / float(settings.steps),
                    crossing                                  ? 0.0F
                    : settings.quadrature == Quadrature::kEnd ? 1.0F
                                                              : 0.5F,
                    float(crossing ? settings.steps : settings.steps - 1)};
  StartedRays started(march, rays);
  LaneRays vectors[kTogether];
  for (size_t under_way = kTogether; under_way > 0;) {
    under_way = 0;
    for (LaneRays& vector : vectors) {
      Marching marching = load(vector.fields);
      const Mask live = hn::Le(marching.j, marching.last);
      const size_t count = hn::CountTrue(d, live);
      if (count == 0 || (count + kEnded <= hn::Lanes(d) && !started.empty())) {
        vector.replaceEnded(march, marching, started, lengths);
        under_way += vector.count;
      } else {
        advance(march, marching, live);
        storeMoved(marching, vector.fields);
        ++under_way;
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cloudbake
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cloudbake {

HWY_EXPORT(MarchRays);

void marchRays(const DenseField& field, const RayArrays& rays, const MarchSettings& settings, float* lengths) {
  HWY_DYNAMIC_DISPATCH(MarchRays)(field, rays, settings, lengths);
}

}  // namespace cloudbake
#endif
