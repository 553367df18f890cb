#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\n") #end
#macro S(T) #debug concat(T, "\n") #end
#debug "BEGIN\n"
#macro A(V) #switch (V) #case (1) F(1) #case (2) F(2) #break #range (3, 5) F(3) #break #else F(9) #end #end A(1) A(2) A(4) A(7)
#debug "END\n"
sphere { 0, 1 }
