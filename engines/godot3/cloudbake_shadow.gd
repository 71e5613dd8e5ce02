# Casts the shadow of a cloud on everything below it: attach this script to a MeshInstance, which needs no mesh, and give it the two files
# that `cloudbake shadow` writes. The shadow lies where the asset was when the picture was made. GLES3 only.
extends MeshInstance

export(Texture) var picture    # import it without compression and without mipmaps
export(String, FILE, "*.json") var frame    # for an exported game, add *.json to the files that are exported
export(float, 0.0, 1.0) var shadow_strength = 1.0


func _ready():
	mesh = QuadMesh.new()
	mesh.size = Vector2(2, 2)    # it covers the screen
	extra_cull_margin = 16384
	cast_shadow = GeometryInstance.SHADOW_CASTING_SETTING_OFF
	material_override = ShaderMaterial.new()
	material_override.shader = load(get_script().resource_path.get_base_dir() + "/cloudbake_shadow.shader")
	material_override.render_priority = -1    # before other transparent things
	var file = File.new()
	if file.open(frame, File.READ) != OK:
		push_error("%s: cannot be read; `cloudbake shadow` writes it beside the picture" % frame)
		return
	var values = JSON.parse(file.get_as_text()).result
	_set_frame(values)


func _process(_delta):
	_set_value("shadow_strength", shadow_strength)
	var camera = get_viewport().get_camera()
	if camera:
		global_transform.origin = camera.global_transform.origin


#include "godot_shadow.gd"


func _set_value(name, value):
	material_override.set_shader_param(name, value)
