# Plays a sequence (`cloudbake sequence --as picture`). cloudbake_import.gd attaches this script to the scene of the asset.
extends Spatial

signal finished    # the last frame is reached, and the sequence does not begin again

export var playing = true
export var loop = false    # begins again after the last frame; what `cloudbake sequence --loop` made always does, without a jump
export var speed = 1.0
export var seconds = 0.0    # the moment that is shown

var _sequence = {}    # as the asset describes it
var _parts = []    # the node of each segment


func _ready():
	_sequence = get_meta("sequence")
	_parts.resize(_sequence.segments.size())
	_find_parts(self)
	if _sequence.loops and _parts.size() == 1:    # its end fades into its own beginning
		_parts.append(_parts[0].duplicate())
		_parts[0].get_parent().add_child(_parts[1])
	for part in _parts:
		var material = part.material_override if part.material_override else part.mesh.surface_get_material(0)
		part.material_override = material.duplicate()    # each instance of the sequence has a time of its own
		part.material_override.set_shader_param("sequence_place", part.get_meta("sequence_place"))
	_show()


func _process(delta):
	if playing:
		seconds += delta * speed
		if not _sequence.loops and seconds >= duration():
			_end()
	_show()


func play():
	playing = true


func stop():
	playing = false


func seek(moment):
	seconds = moment
	_show()


# After so many seconds a loop repeats. Of other sequences, when their last frame is shown.
func duration():
	return _sequence.period / _sequence.frames_per_second


func _end():
	if loop and duration() > 0:
		seconds = fmod(seconds, duration())
		return
	seconds = duration()
	playing = false
	emit_signal("finished")


func _find_parts(node):
	if node.has_meta("sequence_segment"):
		_parts[node.get_meta("sequence_segment")] = node
	for child in node.get_children():
		_find_parts(child)


func _show():
	var seen = _seen()
	for i in _parts.size():
		_parts[i].visible = i in seen
		if i in seen:
			_parts[i].material_override.set_shader_param("sequence_moment", _moment(_frames_of(i), seen[i].x))
			_parts[i].material_override.set_shader_param("shown", Vector2(seen[i].y, seen[i].z))


func _frames_of(part):
	return _sequence.segments[part % _sequence.segments.size()].frames


# The parts that are seen: of each its frame, and between which thresholds of the dither. In a fade the later one has the pixels below its
# weight, and the earlier one the others.
func _seen():
	var last = _sequence.segments.size() - 1
	var frame = max(0.0, seconds * _sequence.frames_per_second)
	if _sequence.loops and _sequence.period > 0:
		frame = fmod(frame, _sequence.period)
	else:
		frame = min(frame, _frames_of(last)[-1])
	var now = 0
	while now < last and _frames_of(now + 1)[0] <= frame:
		now += 1
	# The one that began before it, which in a loop may reach into the first frames.
	var before = now - 1
	var own = frame
	var begin = _frames_of(now)[0]
	if now == 0:
		before = _parts.size() - 1
		own = frame + _sequence.period
		begin = _sequence.period
	var end = _frames_of(before)[-1]
	if (now == 0 and not _sequence.loops) or end <= own:
		return {now: Vector3(frame, 0, 1)}
	var weight = (own - begin) / (end - begin)
	return {before: Vector3(own, weight, 1), now: Vector3(frame, 0, weight)}


# The last key that is not after a frame, and the share of the way to the next one.
func _moment(frames, frame):
	var key = 0
	while key < frames.size() - 1 and frames[key + 1] <= frame:
		key += 1
	if key == frames.size() - 1:
		return Vector2(key, 0)
	return Vector2(key, clamp((frame - frames[key]) / (frames[key + 1] - frames[key]), 0, 1))
