# Gives the clouds of a scene the painted look of `cloudbake preview`: attach this script to a Node of the scene. It needs the
# renderer Forward+.
# It draws the clouds of the group "cloudbake" apart, softens, swirls and wears their rims, and puts them over the scene by depth. Colours
# of sun and sky are those of the first cloud's material. Lengths are of the world unless it says otherwise.
extends Node

@export_range(1, 8) var samples_per_side = 2    # so many times as wide and high are the clouds drawn before they are averaged
@export_range(0.1, 1.0) var resolution = 1.0    # of the picture of the clouds, against that of the screen
@export_range(1, 20) var layer = 20    # only clouds may be in it
@export var time_scale = 1.0
@export var time = 0.0    # seconds; the swirls move with it

@export var size = 0.0    # the mean of the clouds' longest sides; 0: measured when clouds come or go
@export var near_distance = @chain_near_distance@
@export var far_distance = @chain_far_distance@    # where the depth is 1; 0: ten sizes beyond near_distance

@export_range(0.0, 1.0) var half_lambert = @light_half_lambert@
@export var volume_gain = @light_volume_gain@    # brightens clouds that were fitted to a volume
@export_range(0.0, 1.0) var phase_share = @light_phase@
@export_range(0.0, 0.99) var phase_asymmetry = @light_phase_asymmetry@
@export var phase_limit = @light_phase_limit@

# Of the fog on clouds: by depth, or with distance_fog over 0 by distance.
@export var fog_density = @fog_density@
@export var distance_fog = @fog_per_unit@
@export var fog_color = Vector3(@fog_color@)    # linear
@export var fog_scatter = Vector2(@fog_scatter@, @fog_scatter_exponent@)    # strength and exponent of the light around the sun

# The steps; widths and strengths are of the picture's height.
@export var depth_spread = @chain_depth_spread@
@export var near_width = @chain_near_width@
@export var far_width = @chain_far_width@
@export var tile_size = @chain_tile_size@
@export var far_tiles = @chain_far_tiles@
@export var swirl_strength = @chain_swirl_strength@
@export var far_strength = @chain_far_strength@
@export var swirl_speed = @chain_swirl_speed@    # cycles per second
@export var near_drift = Vector2(@chain_near_drift@)
@export var far_drift = Vector2(@chain_far_drift@)
@export_range(0.0, 1.0) var dark = @chain_dark@
@export var noise_seed: int = @chain_seed@
@export var detail_size = @chain_detail_size@    # of the clouds' size
@export_range(0.0, 0.99) var detail_shrink = @chain_detail_shrink@
@export_range(0.0, 1.0) var detail_darkening = @chain_detail_darkening@

# Fades, 0: none.
@export var soft_distance = 0.0    # clouds fade in over it before solid things
@export var near_fade = Vector2()    # distances at which clouds are gone, and from which they are whole
@export var far_fade = Vector2()    # distances from which clouds fade, and at which they are gone

const ALONG_ROWS = Vector2i(1, 0)
const ALONG_COLUMNS = Vector2i(0, 1)

var _eye = Camera3D.new()
var _last: SubViewport    # that of the last step
var _composite = MeshInstance3D.new()

#include "godot_painted.gd"


func _process(delta):
	time += delta * time_scale
	var camera = get_viewport().get_camera_3d()
	if camera == null:
		return
	if not camera in _cameras:
		_cameras[camera] = camera.cull_mask & _bit()
	camera.cull_mask &= ~_bit()
	_find_clouds()
	var picture = Vector2(get_viewport().size)
	var small = (picture * resolution).ceil()
	for pass_name in _passes:
		_passes[pass_name].size = Vector2i(small) * (samples_per_side if pass_name == "clouds" else 1)
	_follow(camera)
	_set_values(camera, picture, small)


func _viewport(pass_name):
	var viewport = SubViewport.new()
	viewport.name = pass_name
	viewport.use_hdr_2d = true    # else it has 8 bits
	viewport.transparent_bg = true
	viewport.disable_3d = pass_name != "clouds"
	viewport.gui_disable_input = true
	viewport.render_target_update_mode = SubViewport.UPDATE_ALWAYS
	# Godot draws viewports before those that they are in: each step has the one before it.
	if _last:
		remove_child(_last)
		viewport.add_child(_last)
	add_child(viewport)
	_last = viewport
	_passes[pass_name] = viewport
	return viewport


func _shader(shader_name):
	return load(get_script().resource_path.get_base_dir() + "/painted/%s.gdshader" % shader_name)


func _make_composite():
	_composite.mesh = QuadMesh.new()
	_composite.mesh.size = Vector2(2, 2)
	_composite.material_override = _material("composite", {"channels": "worn", "drawn": "drawn"})
	_composite.extra_cull_margin = 16384
	_composite.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	add_child(_composite)


func _materials_of(node):
	var materials = []
	var mesh = node.multimesh.mesh if node is MultiMeshInstance3D else node.mesh
	if node.material_override:
		materials.append(node.material_override)
	else:
		for surface in mesh.get_surface_count():
			materials.append(mesh.surface_get_material(surface))
	var own = []
	for material in materials:
		if material is ShaderMaterial:
			own.append(material)
	return own


# The mean of the longest sides of the clouds' boxes.
func _measure():
	var sum = 0.0
	for node in _clouds:
		sum += (node.global_transform * node.get_aabb()).get_longest_axis_size()
	return sum / _clouds.size() if _clouds else 1.0


# How far the near and the far noise have moved, in tiles of their own. The rows of Godot 4 count from the top, those of the steps from the
# bottom, so up is down in them.
func _drift():
	var cycles = time * swirl_speed
	var near = cycles * near_drift
	var far = cycles * far_drift * far_tiles
	return Vector4(fposmod(near.x, 1.0), fposmod(-near.y, 1.0), fposmod(far.x, 1.0), fposmod(-far.y, 1.0))


# The uniforms of view.glsl for a picture that shows what the camera sees, with its rows from the top.
func _view(camera, picture):
	var basis = _eye.global_transform.basis
	var side = picture.y if camera.keep_aspect == Camera3D.KEEP_HEIGHT else picture.x
	return {"eye": _eye.global_transform.origin, "right": basis.x, "up": -basis.y, "forward": -basis.z, "picture": picture,
		"per_pixel": 2 * tan(deg_to_rad(camera.fov) / 2) / side}


func _put(material, parameter, value):
	material.set_shader_parameter(parameter, value)


func _value_of(material, parameter):
	return material.get_shader_parameter(parameter)
