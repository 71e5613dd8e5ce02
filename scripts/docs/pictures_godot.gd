# Saves what the example of the Godot kit shows: godot3 --path PROJECT --resolution 960x640 -s PLACE/pictures_godot.gd
extends SceneTree


func _init():
	root.add_child(load("res://main.tscn").instance())
	for frame in 5:
		yield(self, "idle_frame")
	var picture = root.get_texture().get_data()
	picture.flip_y()
	picture.save_png("res://picture.png")
	quit()
