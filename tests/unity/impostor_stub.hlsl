// What CloudbakeImpostor.shader uses besides of Unity's libraries.
cbuffer PerView {
  float4x4 unity_WorldToObject, unity_MatrixP, unity_MatrixVP, unity_MatrixIV;
  float4 _ScreenParams, unity_OrthoParams;
};
#define UNITY_MATRIX_I_M unity_WorldToObject
#define UNITY_MATRIX_P unity_MatrixP
#define UNITY_MATRIX_VP unity_MatrixVP
#ifndef UNITY_MATRIX_V
#define UNITY_MATRIX_V unity_MatrixIV
#endif
