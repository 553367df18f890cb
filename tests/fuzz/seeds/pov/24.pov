#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\n") #end
#macro S(T) #debug concat(T, "\n") #end
#debug "BEGIN\n"
#declare C = srgb <.5, .25, 1>; F(C.red) F(C.green) F(C.blue)
#debug "END\n"
sphere { 0, 1 }
