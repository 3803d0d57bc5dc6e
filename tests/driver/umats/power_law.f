C     Incompressible-like viscous fluid of power n, written for the tests: with the mean logarithmic
C     rate D of the increment, s = K r**(n-1) D', r**2 = 2/3 D':D' + floor**2, plus linear bulk
C     viscosity KB tr D. PROPS: K, n, KB, rate floor (1/s), strain floor.
C     The strain increments are logarithmic, for diagonal F. With sigma instead of tau the tangent
C     has the term sigma (x) I: it is not symmetric.
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,
     1 DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,
     2 CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     3 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'header.inc'
      CHARACTER*80 CMNAME
      DOUBLE PRECISION D(6),R2,ETA,SLOPE,TR,W(6)
      INTEGER I,J
      TR = LOG(DFGRD1(1,1)*DFGRD1(2,2)*DFGRD1(3,3)
     1   /(DFGRD0(1,1)*DFGRD0(2,2)*DFGRD0(3,3)))/DTIME
      DO I = 1, 6
        W(I) = 1.D0
        IF (I .GT. 3) D(I) = DSTRAN(I)/DTIME
        IF (I .LE. 3)
     1    D(I) = LOG(DFGRD1(I,I)/DFGRD0(I,I))/DTIME - TR/3.D0
        IF (I .GT. 3) D(I) = 0.5D0*D(I)
        IF (I .GT. 3) W(I) = 2.D0
      END DO
      R2 = MAX(PROPS(4), PROPS(5)/DTIME)**2
      DO I = 1, 6
        R2 = R2 + W(I)*D(I)*D(I)/1.5D0
      END DO
      ETA = PROPS(1)*R2**(0.5D0*(PROPS(2)-1.D0))
      SLOPE = ETA*(PROPS(2)-1.D0)/R2/1.5D0
      DO I = 1, 6
        STRESS(I) = ETA*D(I)
        IF (I .LE. 3) STRESS(I) = STRESS(I) + PROPS(3)*TR
        DO J = 1, 6
          DDSDDE(I,J) = SLOPE*D(I)*D(J)/DTIME
          IF (I .LE. 3 .AND. J .LE. 3) DDSDDE(I,J) = DDSDDE(I,J)
     1      + (PROPS(3) - ETA/3.D0)/DTIME
        END DO
        DO J = 1, 3
          DDSDDE(I,J) = DDSDDE(I,J) + STRESS(I)
        END DO
        IF (I .LE. 3) DDSDDE(I,I) = DDSDDE(I,I) + ETA/DTIME
        IF (I .GT. 3) DDSDDE(I,I) = DDSDDE(I,I) + 0.5D0*ETA/DTIME
      END DO
      END
