#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\n") #end
#macro S(T) #debug concat(T, "\n") #end
#debug "BEGIN\n"
F(1 + 2 * 3) F(-2 * -3) F(7 - 2 - 1) F(8 / 2 / 2)
#debug "END\n"
sphere { 0, 1 }
