// cloudbake @version@: gives an impostor the bounds of the ball that its square may show, so that cameras do not leave it out.
using UnityEngine;

[ExecuteAlways]
[AddComponentMenu("Cloudbake/Impostor")]
public sealed class CloudbakeImpostor : MonoBehaviour
{
    [Tooltip("Of the ball, in the object's space.")]
    public Vector3 center;
    public float radius = 1;

    void OnEnable()
    {
        foreach (var one in GetComponentsInChildren<Renderer>())
            one.localBounds = new Bounds(center, new Vector3(2 * radius, 2 * radius, 2 * radius));
    }
}
