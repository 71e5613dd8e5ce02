// cloudbake @version@: plays a sequence (`cloudbake sequence --as picture`) whose renderers have the shader Cloudbake/Cloud. Assets >
// Cloudbake > Create Sequence adds it.
using System;
using UnityEngine;

[ExecuteAlways]
[AddComponentMenu("Cloudbake/Sequence")]
public sealed class CloudbakeSequence : MonoBehaviour
{
    [Serializable]
    public sealed class Part
    {
        public Renderer renderer;
        public Vector4 place;  // the first row of its keys, the rows that its vertices need, and how many keys it has
        public float[] frames = new float[0];
    }

    public bool playing = true;
    [Tooltip("Begins again after the last frame. What `cloudbake sequence --loop` made always does, without a jump.")]
    public bool loop;
    public float speed = 1;
    [Tooltip("The moment that is shown.")]
    public double seconds;

    [Header("From the file")]
    public float framesPerSecond = 24;
    public float period;
    public bool loops;
    [Tooltip("In the object's space.")]
    public Bounds box;
    [Tooltip("One for each segment. A loop of one segment fades into itself, and has it twice.")]
    public Part[] parts = new Part[0];

    MaterialPropertyBlock values;

    // After so many seconds a loop repeats. Of other sequences, when their last frame is shown.
    public double Duration => period / framesPerSecond;

    public void Play() => playing = true;
    public void Stop() => playing = false;

    public void Seek(double moment)
    {
        seconds = moment;
        Show();
    }

    void OnEnable()
    {
        foreach (var part in parts) part.renderer.localBounds = box;
        Show();
    }

    void Update()
    {
        if (playing && Application.isPlaying)
        {
            seconds += Time.deltaTime * speed;
            if (!loops && seconds >= Duration)
            {
                playing = loop && Duration > 0;
                seconds = playing ? seconds % Duration : Duration;
            }
        }
        Show();
    }

    static bool IsTwice(Part[] parts) => parts.Length == 2 && parts[0].place == parts[1].place;

    void Show()
    {
        if (parts.Length == 0) return;
        var frames = Array.ConvertAll(parts, part => part.frames);
        var seen = CloudbakeMath.Seen(frames, IsTwice(parts) ? 1 : parts.Length, seconds * framesPerSecond, loops ? period : 0);
        values = values ?? new MaterialPropertyBlock();
        for (var i = 0; i < parts.Length; ++i)
        {
            var own = Array.FindIndex(seen, one => one.part == i);
            parts[i].renderer.enabled = own >= 0;
            if (own < 0) continue;
            values.SetVector("sequence_place", parts[i].place);
            values.SetVector("sequence_moment", CloudbakeMath.Moment(frames[i], seen[own].frame));
            values.SetVector("_SequenceShown", new Vector4(seen[own].from, seen[own].to, 0, 0));
            parts[i].renderer.SetPropertyBlock(values);
        }
    }
}
