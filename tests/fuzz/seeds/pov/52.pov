#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\n") #end
#macro S(T) #debug concat(T, "\n") #end
#debug "BEGIN\n"
#declare P = spline { linear_spline 0, <0, 0, 0> 1, <1, 2, 0> 3, <2, -1, 5> 4, <7, 7, 7> 6, <0, 1, 2> }
#for (I, -1, 7, .25) M(P(I)) #end
#debug "END\n"
sphere { 0, 1 }
