// The atlas of an impostor.
uniform highp sampler2D impostor_lobe, impostor_rest;
uniform vec4 impostor_atlas;  // views, pixels to a side of a frame, the last mip level, the thickness of the value 1.0
