#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\n") #end
#macro S(T) #debug concat(T, "\n") #end
#debug "BEGIN\n"
M(vaxis_rotate(<1, 2, 3>, <1, 1, 0>, 50)) M(vaxis_rotate(y, x, 90))
#debug "END\n"
sphere { 0, 1 }
