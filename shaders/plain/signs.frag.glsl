// Counts surfaces along the view: those into the cloud less those out of it, which are 0 where the mesh is closed, and all of them.
out vec4 value;

void main() {
  value = vec4(gl_FrontFacing ? 1.0 : -1.0, 1.0, 0.0, 0.0);
}
