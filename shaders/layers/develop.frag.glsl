// From linear to display-referred colours.
uniform highp sampler2D composed;
uniform float exposure;
uniform bool sqrt_gamma;
out vec4 value;

void main() {
  vec3 color = texelFetch(composed, ivec2(gl_FragCoord.xy), 0).rgb;
  value = vec4(sqrt_gamma ? sqrt(max(vec3(0.0), color * exposure)) : toneMap(color, exposure), 1.0);
}
