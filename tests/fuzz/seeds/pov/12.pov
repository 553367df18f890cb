#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\n") #end
#macro S(T) #debug concat(T, "\n") #end
#debug "BEGIN\n"
M(<1, 2, 3> + <4, 5, 6>) M(<1, 2, 3> * 2) M(2 / <1, 2, 4>) M(<1, 2, 3> - 1)
#debug "END\n"
sphere { 0, 1 }
