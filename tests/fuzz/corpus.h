// Grammars from the literature and from Houdini's help, as lists of rules: seeds for mutation beside the presets.
#pragma once

#include <array>

namespace cloudbake {

constexpr std::array kSeedRules{
    "premise: A\nA=AB\nB=A\n",
    "premise: ABC\nA<B=DOG\nB>A=DOG\n",
    "premise: F\nF=F+F--F+F\n",
    "premise: F-F-F-F\nF=F-F+F+FF-F-F+F\n",
    "premise: F(1,1,1,3,0)\nF(i,j,k,l,m):m=0=F(i,j,k,l,0)+F(i,j,k,l,1)+\nF(i,j,k,l,m):m=1=-F(i,j,k,l,0)-F(i,j,k,l,1)\n",
    "premise: F\nF=G-F-G\nG=F+G+F\n",
    "premise: L\nL=+RF-LFL-FR+\nR=-LF+RFR+FL-\n",
    "premise: A\nA=B-F+CFC+F-D&F^D-F+&&CFC+F+B//\nB=A&F^CFB^F^D^^-F-D^|F^B|FC^F^A//\nC=|D^|F^B-F+C^F^A&&FA&F^C+F+B^F^D//\n"
    "D=|CFB-F+B|FA&F^A&&FB-F+B|FC//\n",
    "premise: X\nX=F-[[X]+X]+F[+FX]-X\nF=FF\n",
    "premise: l\nl:t<b=l+r+\nr:t<b=-l-r\nl=F\nr=F\n",
    "premise: A\nA=[&FL!A]/////'[&FL!A]///////'[&FL!A]\nF=S/////F\nS=FL\n",
    "premise: FFFA\nA=!\"[B]////[B]////B\nB=&FFFA\n",
    "premise: A(0)\nA(i):i<5=A(i+1)A(i+1)\n",
    "premise: FA\nA:y>2=J\nA=FA\n",
    "premise: A(3)\nA(x):x==3->B(x^2)\n",
    "premise: J(,,4)\nJ(a,b,n)=J(,,n+1)\n",
    "context_ignore: []\npremise: A[Q]BF[A]\nA>B=F\nF<A=B\n",
    "premise: A(2)B(5)\nA(i)<B(j):i<j=C(i+j)\n",
    "premise: FA\nA=[+FA%FFF]FA\n",
    "premise: F\nF=F[+F]F[-F]F:0.33\nF=F[+F]F:0.33\nF=F[-F]F:0.34\n",
    "premise: +(90)*&(90)F$(5,1,0)F{.F.F.}g(3)a(\"pscale\",0.3)F(1,,4)T(30)F\nF=~(9)F;F@F_F?F#'F\n"};

}  // namespace cloudbake
