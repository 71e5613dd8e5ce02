const FAR_SIZES = @far_sizes@
const SWIRL_NOISE = {"octaves": @swirl_octaves@, "gain": @swirl_gain@, "cells": @swirl_cells@, "typical_slope": @swirl_slope@}
const EROSION_NOISE = {"octaves": @erosion_octaves@, "gain": @erosion_gain@, "fading": Vector2(@erosion_fading@)}

var _clouds = []    # the nodes
var _shaders = {}    # materials of the clouds, and the shaders that they have by themselves
var _layers = {}    # nodes, and their layers
var _cameras = {}    # cameras, and whether they saw the layer of the clouds
var _measured = 1.0    # the clouds' size
var _passes = {}    # viewports by the name of what they make


func _ready():
	process_priority = 1000    # after everything that moves the camera
	_eye.cull_mask = _bit()
	_eye.environment = Environment.new()
	var clouds = _viewport("clouds")
	clouds.add_child(_eye)
	_eye.current = true
	_pass("drawn", "resolve", {"samples": "clouds"})

	_pass("depths", "weighted", {"channels": "drawn", "of_depth": true})
	_boxes("depths", "drawn", ["depth_rows", "depth_boxes"])
	_pass("spread", "spread", {"channels": "drawn", "weighted": "depth_boxes"})

	_pass("lights", "weighted", {"channels": "spread", "of_depth": false})
	_boxes("lights", "spread", ["light_rows", "light_boxes"])
	_boxes("light_boxes", "spread", ["light_rows2", "light_boxes2"])
	_pass("soft", "soft", {"channels": "spread", "weighted": "light_boxes2"})

	_pass("swirled", "distort", {"channels": "soft"})
	_pass("worn", "erode", {"channels": "swirled"})
	_make_composite()


func _exit_tree():
	for material in _shaders:
		material.shader = _shaders[material]
	for node in _layers:
		if is_instance_valid(node):
			node.layers = _layers[node]
	for camera in _cameras:
		if is_instance_valid(camera):
			camera.cull_mask |= _cameras[camera]
	_cameras.clear()
	_shaders.clear()
	_layers.clear()
	_clouds.clear()


func _bit():
	return 1 << (layer - 1)


# A step that fills the viewport `pass_name` by a shader, from other viewports and from values.
func _pass(pass_name, shader, values):
	var fill = ColorRect.new()
	fill.name = "Fill"
	fill.anchor_right = 1
	fill.anchor_bottom = 1
	fill.material = _material(shader, values)
	_viewport(pass_name).add_child(fill)


func _boxes(image, channels, names):
	_pass(names[0], "box", {"image": image, "channels": channels, "axis": ALONG_ROWS})
	_pass(names[1], "box", {"image": names[0], "channels": channels, "axis": ALONG_COLUMNS})


func _material(shader, values):
	var material = ShaderMaterial.new()
	material.shader = _shader(shader)
	for name in values:
		var value = values[name]
		_put(material, name, _passes[value].get_texture() if value is String else value)
	return material


func _find_clouds():
	var found = []
	for node in get_tree().get_nodes_in_group("cloudbake"):
		if node.get_viewport() == get_viewport() and not node.has_meta("impostor"):
			found.append(node)
	for node in found:
		if not node in _layers:
			_layers[node] = node.layers
			node.layers = _bit()
		for material in _materials_of(node):
			if not material in _shaders:
				_shaders[material] = material.shader
				material.shader = _shader("sequence_channels" if node.has_meta("sequence_segment") else "channels")
	if found != _clouds:
		_clouds = found
		_measured = _measure()


func _follow(camera):
	_eye.global_transform = camera.get_camera_transform()
	_eye.keep_aspect = camera.keep_aspect
	_eye.set_perspective(camera.fov, camera.near, camera.far)
	_composite.global_transform = _eye.global_transform


# The phases of the swirls: the first, the second, and the weight of the second.
func _phases():
	var first = fposmod(time * swirl_speed, 1.0)
	return Vector3(first, fposmod(first + 0.5, 1.0), abs(2 * first - 1))


func _set_values(camera, picture, small):
	var own_size = size if size > 0 else _measured
	var depth_range = Vector2(near_distance, far_distance if far_distance > 0 else near_distance + FAR_SIZES * own_size)
	var origin = _clouds[0].global_transform.origin if _clouds else Vector3.ZERO
	for material in _shaders:
		for pair in [["depth_range", depth_range], ["painted_near_fade", near_fade], ["painted_half_lambert", half_lambert],
				["painted_volume_gain", volume_gain]]:
			_put(material, pair[0], pair[1])
	_set_step("drawn", {"samples_per_side": samples_per_side})
	for name in ["depth_rows", "depth_boxes"]:
		_set_step(name, {"near_half": depth_spread * small.y, "far_half": depth_spread * small.y})
	for name in ["light_rows", "light_boxes", "light_rows2", "light_boxes2"]:
		_set_step(name, {"near_half": near_width * small.y, "far_half": far_width * small.y})
	_set_step("swirled", {"tile_size": tile_size, "far_tiles": far_tiles, "swirl_strength": swirl_strength, "far_strength": far_strength,
		"phases": _phases(), "drift": _drift(), "seed": noise_seed, "dark": dark})
	_set_step("swirled", SWIRL_NOISE)
	_set_step("worn", {"depth_range": depth_range, "noise_origin": origin, "noise_size": detail_size * own_size, "shrink": detail_shrink,
		"darkening": detail_darkening, "seed": noise_seed})
	_set_step("worn", EROSION_NOISE)
	_set_step("worn", _view(camera, small))

	var values = _view(camera, picture)
	values.fog_density = fog_density
	values.distance_fog = distance_fog
	values.fog_color = fog_color
	values.fog_scatter = fog_scatter
	values.depth_range = depth_range
	values.phase = Vector3(phase_share, phase_asymmetry, phase_limit)
	values.soft_distance = soft_distance
	values.far_fade = far_fade
	if _shaders:
		for name in ["to_sun", "sun_color", "ambient_sky", "ambient_ground"]:
			var value = _value_of(_shaders.keys()[0], name)
			if value != null:
				values[name] = value.normalized() if name == "to_sun" else value
	_write(_composite.material_override, values)


func _set_step(step, values):
	_write(_passes[step].get_node("Fill").material, values)


func _write(material, values):
	for name in values:
		_put(material, name, values[name])
