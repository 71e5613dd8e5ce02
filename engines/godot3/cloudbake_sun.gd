# Turns the light of mesh clouds towards a DirectionalLight: attach this script to it. It works in the editor too.
# It finds the clouds by the group "cloudbake", in which cloudbake_import.gd puts them. Add nodes that you make yourself, such as a
# MultiMeshInstance of a cloud's mesh.
tool
extends DirectionalLight


func _process(_delta):
	var to_sun = global_transform.basis.z.normalized()
	for node in get_tree().get_nodes_in_group("cloudbake"):
		var mesh = node.multimesh.mesh if node is MultiMeshInstance else node.mesh
		for surface in mesh.get_surface_count():
			_turn(mesh.surface_get_material(surface), to_sun)
		_turn(node.material_override, to_sun)


func _turn(material, to_sun):
	if material is ShaderMaterial:
		material.set_shader_param("to_sun", to_sun)
