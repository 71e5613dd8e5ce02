// The surfaces of other layers that a ray meets: cutsAt of preview/layer.h.
uniform highp sampler2D cuts_0, cut_places_0, cuts_1, cut_places_1;
uniform int cut_count;
uniform vec2 cut_sides;  // samples to a side of a pixel

void addCut(inout Cuts cuts, vec4 color, float distance) {
  if (!(color.a > 0.0) || distance >= NOWHERE) {
    return;
  }
  bool is_opaque = color.a >= 1.0;
  if (cuts.count == 1 && distance < cuts.distances.x) {
    cuts.distances = vec2(distance, cuts.distances.x);
    cuts.are_opaque = bvec2(is_opaque, cuts.are_opaque.x);
  } else {
    cuts.distances[cuts.count] = distance;
    cuts.are_opaque[cuts.count] = is_opaque;
  }
  cuts.count++;
}

Cuts cutsAt(ivec2 at, int samples_per_side) {
  Cuts cuts = Cuts(0, vec2(NOWHERE), bvec2(false));
  ivec2 first = at * int(cut_sides.x) / samples_per_side;
  ivec2 second = at * int(cut_sides.y) / samples_per_side;
  if (cut_count > 0) {
    addCut(cuts, texelFetch(cuts_0, first, 0), texelFetch(cut_places_0, first, 0).x);
  }
  if (cut_count > 1) {
    addCut(cuts, texelFetch(cuts_1, second, 0), texelFetch(cut_places_1, second, 0).x);
  }
  return cuts;
}
