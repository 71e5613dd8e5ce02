// The mesh clouds as a layer: meshCloudLayer of preview/mesh_clouds/mesh_clouds.h.
layout(location = 0) out vec4 color;
layout(location = 1) out vec4 place;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 p = channelsAt(channels, at);
  color = vec4(0.0);
  place = vec4(1e30);
  if (p.z > 0.0) {
    vec3 view = viewDirection(gl_FragCoord.xy);
    color = vec4(mix((litCloud(p, view) + lampsAt(at)) * ownColor(at), fogColor(view), 1.0 - exp(-fog_density * p.w)), p.z);
    place = vec4(distanceOf(p, at) / dot(view, forward));
  }
}
