#include "bake/fit_lobe.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace cloudbake {
long g_evals=0;
namespace {

constexpr size_t kLanes = 8;

inline int32_t bitsOf(float x) { return std::bit_cast<int32_t>(x); }
inline float atLeast(float x, float low) { return std::bit_cast<float>(std::max(bitsOf(x), bitsOf(low))); }
inline float atMost(float x, float high) { return std::bit_cast<float>(std::min(bitsOf(x), bitsOf(high))); }
inline float expMinus(float t) {
  const float x = -atMost(t, 87.0F);
  const float shifted = x * 1.44269504F + 0x1.8p23F, n = shifted - 0x1.8p23F;
  const float r = (x - n * 0.693359375F) + n * 2.12194440e-4F;
  const float p = ((((1.9875691500e-4F * r + 1.3981999507e-3F) * r + 8.3334519073e-3F) * r + 4.1665795894e-2F) * r + 1.6666665459e-1F) * r + 5.0000001201e-1F;
  return (p * r * r + r + 1) * std::bit_cast<float>((bitsOf(shifted) << 23) + 0x3F800000);
}
inline float minusLog(float x) {
  const int32_t bits = bitsOf(x), e = (bits - 0x3F3504F3) >> 23;
  const float t = std::bit_cast<float>(bits - (e << 23)) - 1, n = float(e);
  float p = ((((((((7.0376836292e-2F*t-1.1514610310e-1F)*t+1.1676998740e-1F)*t-1.2420140846e-1F)*t+1.4249322787e-1F)*t-1.6668057665e-1F)*t+2.0000714765e-1F)*t
                        -2.4999993993e-1F)*t+3.3333331174e-1F);
  return -((t * t * (t * p - 0.5F) + t) + n * 0.69314718F);
}
struct Rays {
  size_t count = 0;
  std::vector<float> x, y, z, weight, ratio, target;  // target: #σ × count
};
struct Scratch { std::vector<float> ju,jv,jd,wu,wv,wd, thickness, error, pull, stiffness; };

struct NormalEquations {
  double error = 0;
  std::array<double, 3> gradient{};
  std::array<double, 6> hessian{};
};

struct Point { Vec3 o; float depth; };


double dotOf(const float* __restrict a,const float* __restrict b,size_t n){
  float s[kLanes]={};
  for(size_t j=0;j<n;j+=kLanes) for(size_t q=0;q<kLanes;++q) s[q]+=a[j+q]*b[j+q];
  return ((double(s[0])+s[1])+(double(s[2])+s[3]))+((double(s[4])+s[5])+(double(s[6])+s[7]));
}
NormalEquations evaluate(const Rays& rays, const Point& lobe, float k, float b, Scratch& s) {
  ++g_evals;
  const size_t n = rays.count;
  const Vec3 o = lobe.o;
  const float d=lobe.depth;
  const Frame f = frameAround(o);
  const Vec3 tu=f.tangent, tv=f.bitangent;
  float* __restrict ju = s.ju.data(); float* __restrict jv = s.jv.data(); float* __restrict jd = s.jd.data(); float* __restrict th = s.thickness.data();
  float* __restrict e=s.error.data(), * __restrict p=s.pull.data(), *__restrict st=s.stiffness.data();
  {
    const float* __restrict x = rays.x.data(); const float* __restrict y = rays.y.data(); const float* __restrict z = rays.z.data();
    const float half_k=0.5F*k;
#pragma GCC ivdep
    for (size_t j = 0; j < n; ++j) {
      const float c = (x[j] * o.x + y[j] * o.y + z[j] * o.z) * 0.5F + 0.5F, h = atLeast(c, 1e-7F);
      const float a = expMinus(k * minusLog(h)) * d, t = a + b;
      const float on = t > 0.0F ? a : 0.0F;
      th[j] = atLeast(t,0);
      jd[j] = on;
      const float q = half_k * on / h;
      ju[j] = q*(x[j]*tu.x+y[j]*tu.y+z[j]*tu.z);
      jv[j] = q*(x[j]*tv.x+y[j]*tv.y+z[j]*tv.z);
      e[j]=p[j]=st[j]=0;
    }
  }
  for (size_t i = 0; i < rays.ratio.size(); ++i) {
    const float ratio = rays.ratio[i];
    const float* __restrict target = rays.target.data() + i * n;
#pragma GCC ivdep
    for (size_t j = 0; j < n; ++j) {
      const float T = expMinus(ratio * th[j]), r = T - target[j], g = -ratio * T;
      e[j] += r * r, p[j] += g * r, st[j] += g * g;
    }
  }
  float*__restrict wu=s.wu.data(),*__restrict wv=s.wv.data(),*__restrict wd=s.wd.data();
  const float*__restrict w=rays.weight.data();
#pragma GCC ivdep
  for (size_t j = 0; j < n; ++j) { p[j]*=w[j]; const float q=st[j]*w[j]; wu[j]=q*ju[j]; wv[j]=q*jv[j]; wd[j]=q*jd[j]; }
  NormalEquations r;
  r.error = dotOf(w,e,n);
  r.gradient={dotOf(p,ju,n),dotOf(p,jv,n),dotOf(p,jd,n)};
  r.hessian={dotOf(wu,ju,n),dotOf(wu,jv,n),dotOf(wu,jd,n),dotOf(wv,jv,n),dotOf(wv,jd,n),dotOf(wd,jd,n)};
  return r;
}

std::array<double,3> solve(const NormalEquations& e, double mu) {
  const auto& h=e.hessian; const auto& g=e.gradient;
  const double a=h[0]+mu,b=h[1],c=h[2],d=h[3]+mu,f=h[4],i=h[5]+mu;
  const double l10=b/a,l20=c/a,d1=d-l10*b,l21=(f-l20*b)/d1,d2=i-l20*c-l21*l21*d1;
  const double y0=-g[0],y1=-g[1]-l10*y0,y2=-g[2]-l20*y0-l21*y1;
  const double z2=y2/d2,z1=y1/d1-l21*z2,z0=y0/a-l10*z1-l20*z2;
  return {z0,z1,z2};
}

struct Fit { Point p; NormalEquations eq; };

Fit descend(const Rays& rays, Point p, const FitSettings& st, float b, Scratch& s) {
  Fit f{p, evaluate(rays,p,st.shape.exponent,b,s)};
  double mu = 1e-2*std::max({f.eq.hessian[0],f.eq.hessian[3],f.eq.hessian[5]}), nu=2;
  for (int it=0; it<st.iterations; ++it) {
    if (!(mu>0)) break;
    auto h=solve(f.eq,mu);
    const double norm=std::sqrt(h[0]*h[0]+h[1]*h[1]+h[2]*h[2]);
    if(!(norm>1e-5)) break;
    if(norm>1) for(double&x:h)x/=norm;
    const auto&g=f.eq.gradient;const auto&H=f.eq.hessian;
    const double predicted=-(2*(g[0]*h[0]+g[1]*h[1]+g[2]*h[2])+H[0]*h[0]*h[0]+H[3]*h[1]*h[1]+H[5]*h[2]*h[2]+2*(H[1]*h[0]*h[1]+H[2]*h[0]*h[2]+H[4]*h[1]*h[2]));
    const Frame fr=frameAround(f.p.o);
    auto o=normalized(f.p.o+float(h[0])*fr.tangent+float(h[1])*fr.bitangent);
    Point q{*o, f.p.depth*expMinus(-float(h[2]))};
    auto eq=evaluate(rays,q,st.shape.exponent,b,s);
    const double gain=f.eq.error-eq.error, rho=gain/predicted;
    if(gain>0){
      const bool done = gain<st.tolerance*f.eq.error;
      f={q,eq};
      if(done)break;
      const double c=2*rho-1; mu*=std::max(1.0/3,1-c*c*c); nu=2;
    } else { if(predicted<st.tolerance*f.eq.error)break; mu*=nu; nu*=2; }
  }
  return f;
}

void fillTargets(Rays& r, std::span<const float> lengths, float s0) {
  for (size_t i=0;i<r.ratio.size();++i) for (size_t j=0;j<r.count;++j) r.target[i*r.count+j]= j<lengths.size()? expMinus(r.ratio[i]*(lengths[j]*s0)):0;
}
Rays makeRays(std::span<const Vec3> dirs, std::span<const float> weights, const FitSettings& st) {
  Rays r; r.count=(dirs.size()+kLanes-1)/kLanes*kLanes;
  for(auto*v:{&r.x,&r.y,&r.z,&r.weight})v->assign(r.count,0);
  double sum=0; for(size_t j=0;j<dirs.size();++j)sum+=weights.empty()?1:weights[j];
  for(size_t j=0;j<dirs.size();++j){r.x[j]=dirs[j].x;r.y[j]=dirs[j].y;r.z[j]=dirs[j].z;r.weight[j]=float((weights.empty()?1:weights[j])/(sum*double(st.extinctions.size())));}
  for(float e:st.extinctions)r.ratio.push_back(e/st.extinctions[0]);
  r.target.assign(r.count*r.ratio.size(),0);
  return r;
}
Scratch makeScratch(size_t n){Scratch s; for(auto*v:{&s.ju,&s.jv,&s.jd,&s.wu,&s.wv,&s.wd,&s.thickness,&s.error,&s.pull,&s.stiffness})v->assign(n,0);return s;}

Lobe fitOne(const Rays&rays,const Lobe&start,std::span<const float> lengths,const FitSettings&st,Scratch&s){
  const float s0=st.extinctions[0];
  const Point p{start.direction,start.density*s0};
  Fit best=descend(rays,p,st,st.shape.bias*s0,s);
  if (st.extra>0) {

    float longest=0, mean=0; Vec3 m1{};
    size_t jl=0; size_t n=lengths.size();
    for(size_t j=0;j<n;++j){ if(lengths[j]>longest)longest=lengths[j],jl=j; mean+=lengths[j]; m1+=lengths[j]*Vec3{rays.x[j],rays.y[j],rays.z[j]};}
    mean/=n;
    Vec3 bright{}; for(size_t j=0;j<n;++j) bright+= (-rays.target[j])*Vec3{rays.x[j],rays.y[j],rays.z[j]};
    auto tryIt=[&](Point q){Fit f=descend(rays,q,st,st.shape.bias*s0,s); if(f.eq.error<best.eq.error)best=f;};
    auto nb=normalized(bright); if(!nb)nb=p.o;
    auto cont=[&](std::vector<float> ks){Point q=p;for(float kk:ks){FitSettings t=st;t.shape.exponent=kk;q=descend(rays,q,t,st.shape.bias*s0,s).p;}tryIt(q);};
    const float k=st.shape.exponent;
    switch(st.extra){
      case 1: tryIt({*nb,longest*s0}); break;
      case 2: tryIt({p.o,p.depth*k}); break;
      case 3: tryIt({p.o,p.depth*k*k/4}); break;
      case 4: cont({3}); break;
      case 5: cont({1.5f}); break;
      case 6: cont({2,std::sqrt(2*k)}); break;
      case 7: cont({3});tryIt({*nb,longest*s0*k}); break;
      case 8: tryIt({*nb,longest*s0*k}); break;
      case 9: tryIt({*nb,longest*s0*k});tryIt({p.o,p.depth*k}); break;
      case 10: cont({1});break;
      case 11: cont({1,std::sqrt(k)});break;
    }
  }
  return {best.p.o,best.p.depth/s0};
}
}  // namespace

double lobeError(const Lobe& l, const FitSamples& sm, const FitSettings& st){
  Rays r=makeRays(sm.directions,sm.weights,st); fillTargets(r,sm.lengths,st.extinctions[0]); Scratch s=makeScratch(r.count);
  return evaluate(r,{l.direction,l.density*st.extinctions[0]},st.shape.exponent,st.shape.bias*st.extinctions[0],s).error;
}
Lobe fitLobe(const Lobe& start, const FitSamples& sm, const FitSettings& st){
  Rays r=makeRays(sm.directions,sm.weights,st); fillTargets(r,sm.lengths,st.extinctions[0]); Scratch s=makeScratch(r.count);
  return fitOne(r,start,sm.lengths,st,s);
}
std::vector<Lobe> fitLobes(std::span<const Lobe> starts, std::span<const Vec3> directions, std::span<const float> lengths,
                           std::span<const float> weights, const FitSettings& st){
  std::vector<Lobe> out(starts.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0,starts.size(),64),[&](const auto&range){
    Rays r=makeRays(directions,weights,st); Scratch s=makeScratch(r.count);
    for(size_t v=range.begin();v<range.end();++v){auto row=lengths.subspan(v*directions.size(),directions.size()); fillTargets(r,row,st.extinctions[0]); out[v]=fitOne(r,starts[v],row,st,s);}
  });
  return out;
}
}  // namespace cloudbake
