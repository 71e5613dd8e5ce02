# Saves what the example of the Godot kit shows, as picture.png, or in GLES3 with the painted look or the soft one, as painted.png and
# soft.png: LOOK=painted godot3 --video-driver GLES3 --path PROJECT --resolution 960x640 -s PLACE/pictures_godot.gd
extends SceneTree


func _init():
	var look = OS.get_environment("LOOK")
	var main = load("res://main.tscn").instance()
	root.add_child(main)
	if look == "painted":
		paint(main)
	if look == "soft":
		soften(main)
	for frame in 5:
		yield(self, "idle_frame")
	var picture = root.get_texture().get_data()
	picture.flip_y()
	picture.save_png("res://%s.png" % (look if look else "picture"))
	quit()


# As docs/engines/godot.md says.
func paint(main):
	var painted = Node.new()
	painted.set_script(load("res://cloudbake/cloudbake_painted.gd"))
	main.add_child(painted)
	var environment = main.get_node("WorldEnvironment").environment
	environment.tonemap_mode = Environment.TONE_MAPPER_ACES
	environment.tonemap_exposure = 1.1765
	environment.tonemap_white = 8.5196


func soften(main):
	for node in get_nodes_in_group("cloudbake"):
		node.mesh.surface_get_material(0).shader = load("res://cloudbake/cloudbake_soft.shader")
