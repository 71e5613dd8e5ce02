# Plays the sequence res://clip.glb beyond its end, and prints what happens: godot3 --path PROJECT -s res://playing.gd
extends SceneTree

var clip
var ends = 0


func _init():
	clip = load("res://clip.glb").instance()
	clip.connect("finished", self, "count_end")
	root.add_child(clip)
	yield(self, "idle_frame")
	var begin = clip.seconds
	while clip.seconds == begin:
		yield(self, "idle_frame")
	clip.loop = true
	clip.seek(0.999 * clip.duration())
	while clip.seconds > 0.5 * clip.duration():
		yield(self, "idle_frame")
	print("began again, ends: %d" % ends)
	clip.loop = false
	clip.seek(0.999 * clip.duration())
	while clip.playing:
		yield(self, "idle_frame")
	print("stopped at %s of its duration, ends: %d" % [clip.seconds / clip.duration(), ends])
	quit()


func count_end():
	ends += 1
