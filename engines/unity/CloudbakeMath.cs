// cloudbake @version@: what the scripts for Unity compute, without a scene.
using UnityEngine;

public static class CloudbakeMath
{
    // The two phases of the swirls at a time, and the weight of the second.
    public static Vector3 Phases(double seconds, float speed)
    {
        var first = Part(seconds * speed);
        return new Vector3(first, (first + 0.5f) % 1, Mathf.Abs(2 * first - 1));
    }

    // How far the near and the far noise have moved to the right and up, in tiles of their own, without the whole ones.
    public static Vector4 Drift(double seconds, float speed, Vector2 near, Vector2 far, float farTiles)
    {
        var cycles = seconds * speed;
        return new Vector4(Part(cycles * near.x), Part(cycles * near.y), Part(cycles * far.x * farTiles), Part(cycles * far.y * farTiles));
    }

    static float Part(double whole) => (float)(whole - System.Math.Floor(whole));

    // The height of what is seen at a distance of 1.
    public static float HeightAtOne(Matrix4x4 projection) => 2 / projection.m11;

    // How far rims may be outside of a box: 'share' is of the picture's height.
    public static Bounds Widened(Bounds box, Vector3 eye, float heightAtOne, float share)
    {
        var away = (box.center - eye).magnitude + box.extents.magnitude;
        box.Expand(2 * share * heightAtOne * away);
        return box;
    }

    // Of levels of detail: the one that is drawn, the one after it, and how much of the pixels the one after it has. `heights` are the
    // shares of the picture's height under which the next level is drawn, falling; `band` is the share of a height over which it comes.
    public static void Level(float[] heights, float height, float band, out int level, out float share)
    {
        level = 0;
        while (level < heights.Length - 1 && height < heights[level] * (1 - band)) ++level;
        var isLast = level == heights.Length - 1;
        share = isLast || height >= heights[level] ? 0 : (1 - height / heights[level]) / Mathf.Max(band, 1e-6f);
    }

    // The share of the picture's height under which a level is drawn that a bake made for `pixels`, in a picture of a height.
    public static float SwitchHeight(float pixels, int pictureHeight) => Mathf.Clamp(pixels / pictureHeight, 0, 0.99f);

    // A segment of a sequence that is seen: its frame, and between which thresholds of the dither.
    public struct SeenPart
    {
        public int part;
        public float frame, from, to;
    }

    // The parts that are seen at a frame. `frames` are those of the keys of each; there is one for each segment, and a second one for the
    // only segment of a loop. `period` is 0 of a sequence that does not loop, which stays at its last frame. In a fade the later one has
    // the pixels below its weight, and the earlier one the others.
    public static SeenPart[] Seen(float[][] frames, int segments, double frame, float period)
    {
        var last = segments - 1;
        frame = System.Math.Max(frame, 0);
        frame = period > 0 ? frame % period : System.Math.Min(frame, End(frames[last]));
        var now = 0;
        while (now < last && frames[now + 1][0] <= frame) ++now;
        // The one that began before it, which in a loop reaches into the first frames.
        var before = now > 0 ? now - 1 : frames.Length - 1;
        var own = now > 0 ? frame : frame + period;
        var begin = now > 0 ? frames[now][0] : period;
        if ((now == 0 && !(period > 0)) || End(frames[before]) <= own)
            return new[] { new SeenPart { part = now, frame = (float)frame, from = 0, to = 1 } };
        var weight = (float)((own - begin) / (End(frames[before]) - begin));
        return new[] { new SeenPart { part = before, frame = (float)own, from = weight, to = 1 },
            new SeenPart { part = now, frame = (float)frame, from = 0, to = weight } };
    }

    static float End(float[] frames) => frames[frames.Length - 1];

    // The last key that is not after a frame, and the share of the way to the next one.
    public static Vector2 Moment(float[] frames, float frame)
    {
        var key = 0;
        while (key < frames.Length - 1 && frames[key + 1] <= frame) ++key;
        if (key == frames.Length - 1) return new Vector2(key, 0);
        return new Vector2(key, Mathf.Clamp((frame - frames[key]) / (frames[key + 1] - frames[key]), 0, 1));
    }

    // Between the space of glTF and that of Unity, which mirrors x.
    public static Vector3 Mirrored(Vector3 v) => new Vector3(-v.x, v.y, v.z);
}
