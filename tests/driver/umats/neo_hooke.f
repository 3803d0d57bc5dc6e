C     Compressible neo-Hooke at large strain, written for the tests:
C     tau = mu (b - I) + lambda ln(J) I, sigma = tau / J. PROPS: mu, lambda (MPa), then an
C     optional factor on the shear part of the tangent (1 is right, anything else plants an error).
C     STATEV(1), if there is one, counts the accepted increments.
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,
     1 DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,
     2 CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     3 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'header.inc'
      CHARACTER*80 CMNAME
      DOUBLE PRECISION B(3,3),T(3,3),DELTA(3,3),MU,LAMBDA,DETF,FACTOR
      INTEGER I,J,K,L,M,N,ROW(6),COL(6)
      DATA ROW /1,2,3,1,1,2/, COL /1,2,3,2,3,3/
      MU = PROPS(1)
      LAMBDA = PROPS(2)
      FACTOR = 1.D0
      IF (NPROPS .GE. 3) FACTOR = PROPS(3)
      B = MATMUL(DFGRD1, TRANSPOSE(DFGRD1))
      DETF = DFGRD1(1,1)*(DFGRD1(2,2)*DFGRD1(3,3)
     1     - DFGRD1(2,3)*DFGRD1(3,2))
     2     - DFGRD1(1,2)*(DFGRD1(2,1)*DFGRD1(3,3)
     3     - DFGRD1(2,3)*DFGRD1(3,1))
     4     + DFGRD1(1,3)*(DFGRD1(2,1)*DFGRD1(3,2)
     5     - DFGRD1(2,2)*DFGRD1(3,1))
      DELTA = 0.D0
      DO I = 1, 3
        DELTA(I,I) = 1.D0
      END DO
      T = (MU*(B - DELTA) + LAMBDA*LOG(DETF)*DELTA)/DETF
      DO M = 1, NTENS
        I = ROW(M)
        J = COL(M)
        STRESS(M) = T(I,J)
        DO N = 1, NTENS
          K = ROW(N)
          L = COL(N)
          DDSDDE(M,N) = (LAMBDA*DELTA(I,J)*DELTA(K,L)
     1      + (MU - LAMBDA*LOG(DETF))*(DELTA(I,K)*DELTA(J,L)
     2      + DELTA(I,L)*DELTA(J,K)))/DETF
     3      + 0.5D0*(DELTA(I,K)*T(J,L) + DELTA(I,L)*T(J,K)
     4      + DELTA(J,K)*T(I,L) + DELTA(J,L)*T(I,K))
          IF (M .GT. 3 .AND. N .GT. 3) DDSDDE(M,N)=FACTOR*DDSDDE(M,N)
        END DO
      END DO
      SSE = (0.5D0*MU*(B(1,1)+B(2,2)+B(3,3)-3.D0-2.D0*LOG(DETF))
     1    + 0.5D0*LAMBDA*LOG(DETF)**2)
      IF (NSTATV .GE. 1) STATEV(1) = STATEV(1) + 1.D0
      END
