#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\n") #end
#macro S(T) #debug concat(T, "\n") #end
#debug "BEGIN\n"
#declare A = array[2] {1, 2} #declare B = A #declare B[0] = 7; F(A[0]) F(B[0])
#debug "END\n"
sphere { 0, 1 }
