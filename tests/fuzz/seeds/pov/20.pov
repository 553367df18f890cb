#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\n") #end
#macro S(T) #debug concat(T, "\n") #end
#debug "BEGIN\n"
#declare C = rgb <.75, .5, .25>; F(C.red) F(C.gray) F(C.transmit) M(C * 2)
#debug "END\n"
sphere { 0, 1 }
