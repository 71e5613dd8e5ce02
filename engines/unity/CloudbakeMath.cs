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

    // Between the space of glTF and that of Unity, which mirrors x.
    public static Vector3 Mirrored(Vector3 v) => new Vector3(-v.x, v.y, v.z);
}
